"""How the check of recordings is shown: tables and sentences, and a page."""
