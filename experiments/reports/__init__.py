"""Reports: pages in Markdown and HTML, tables on the console, statistics, figures."""
