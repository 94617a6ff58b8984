"""What pages are looked at with: a browser, the widths of tables, what a median must say."""
