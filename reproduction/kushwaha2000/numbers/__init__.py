"""What the table of statements needs computed, by subject."""
