"""What the table of statements needs computed, by subject; `form` is the form of the equations."""
