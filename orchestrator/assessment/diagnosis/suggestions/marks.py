"""The shares from which more than one rule speaks: marks of what is worth a user's time, not physics."""

MOST = 0.5  # of the steps: what sets so many is what limits the run
OFTEN = 0.1  # of the attempts, or of the steps


def percent(share: float) -> str:
    """A share in a sentence."""
    return f"{100.0 * share:.2g} %" if share < 0.995 else "100 %"
