"""Shows a diagnosis: ten lines on the console, an HTML page, and a Rerun file."""
