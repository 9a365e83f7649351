"""For estimators that compare extrapolated signals."""

from ...masters import Jacobi, Master, find_name


def refuse_interpolation(estimator: str, compared: str, master: Master) -> None:
    """ValueError, with the remedy, unless the master extrapolates every signal."""
    if not isinstance(master, Jacobi):
        better = "predictor_corrector or step_doubling" if master.implicit else "step_doubling"
        raise ValueError(
            f"estimator = {estimator!r}: compares extrapolations of {compared}, as the master jacobi makes "
            f"them; {find_name(master)} interpolates some: use {better}"
        )
