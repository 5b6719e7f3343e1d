"""What was measured as tables, a page and plots; nothing here is typed by hand."""
