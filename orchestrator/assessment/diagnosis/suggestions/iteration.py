"""Rules on how often steps are iterated, and on iterations that end nowhere."""

from ....scenario import CONVERGED
from ..facts import Facts
from .marks import OFTEN, percent

MANY_ITERATIONS = 5.0  # a step; a smooth coupling with good signals takes two or three
DENSE = 3.0  # times the mean work


def uneven_work(facts: Facts) -> str | None:
    """Steps of one length need many times more iterations in some intervals than in others."""
    dense = max(facts.diagnosis.densest, key=lambda interval: interval.density, default=None)
    controlled = facts.scenario.step_control or not facts.limits.controllable
    if controlled or dense is None or dense.density < DENSE:
        return None
    return (
        f"{percent(dense.work)} of the iterations fall in {percent(dense.time)} of the time, "
        f"{dense.start:.6g} to {dense.end:.6g} s: [step_control] shortens the steps only there"
    )


def convergence(facts: Facts) -> str | None:
    """Many attempts are rejected because the iteration does not converge."""
    d = facts.diagnosis
    share = d.rejections.get("convergence", 0) / (d.steps + d.rejected)
    if share < OFTEN:
        return None
    if facts.weaker:
        remedy = '[master] acceleration = "quasi_newton"'
    elif facts.scenario.master.name == "iterated":
        remedy = '[master] name = "newton"'
    else:
        most = 2 * facts.master.maximum_iterations
        remedy = (
            f'[master] maximum_iterations = {most}, or step_control.maximum_step = "{d.length["p95"]:.2g} s"'
        )
    return f"{percent(share)} of the attempts were rejected because the iteration did not converge: {remedy}"


def many_iterations(facts: Facts) -> str | None:
    """Many iterations a step, and a sharper tolerance than needed, or a weaker acceleration than there is."""
    mean = facts.diagnosis.mean_iterations
    if not facts.master.implicit or mean < MANY_ITERATIONS:
        return None
    said = f"{mean:.1f} iterations a step: "
    control, tolerance = facts.scenario.step_control, facts.master.tolerance
    if control and tolerance < CONVERGED * control.relative * (1.0 - 1e-9):
        needed = CONVERGED * control.relative
        return (
            f"{said}loosen master.tolerance (now {tolerance:g}) to {needed:g}, {CONVERGED:g} of "
            "step_control.relative, or leave it out"
        )
    if facts.weaker:
        return f'{said}[master] acceleration = "quasi_newton" goes on with what earlier steps learnt'
    return f"{said}the iteration contracts faster with shorter steps: lower " + (
        f"step_control.maximum_step (now the longest are {facts.diagnosis.length['p95']:.2g} s)"
        if control
        else f"macro_step (now {facts.scenario.macro_step:g} s)"
    )


def costly_estimator(facts: Facts) -> str | None:
    """Step doubling where the iteration gives an estimate for nothing."""
    control = facts.scenario.step_control
    if control is None or control.estimator != "step_doubling" or not facts.master.implicit:
        return None
    return (
        'step_control.estimator = "step_doubling" makes every step three times: "predictor_corrector" takes '
        "its estimate from the iteration"
    )
