"""Pages, tables and figures as files."""
