"""Promise by promise, what the code does: `python -m tests.verification` writes docs/verification."""
