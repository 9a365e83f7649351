"""Error over doStep calls of the masters here and of other tools, on problems whose solution is known."""
