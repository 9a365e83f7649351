"""Error over doStep calls of the masters, on problems whose solution is known."""
