"""The diagnosis of a run from its output folder."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from ...errors import MistakeError
from ...run.output_folder import SCENARIO, SUMMARY
from ...scenario import ScenarioError
from ...scenario.files import load
from .facts import Facts
from .numbers import diagnose_steps
from .steps import recorded
from .suggestions import suggestions
from .text import full


def diagnose(out: Path, figure: Path | None, say: Callable[[str], None]) -> None:
    """Say everything about the steps of the run in `out`, and draw them; MistakeError if there is no run."""
    if figure and figure.suffix != ".png":
        raise MistakeError(f"--figure {figure}: must end in .png")
    steps, message = recorded(out)
    diagnosis = diagnose_steps(steps, _do_steps(out / SUMMARY))
    if diagnosis is None:
        raise MistakeError(f"{out}: the run made no step ({message})")
    if not (out / SCENARIO).is_file():
        raise MistakeError(f"{out}: there is no {SCENARIO}, with which the steps are judged; put it back")
    try:
        scenario = load(out / SCENARIO)
    except ScenarioError as error:
        raise MistakeError(f"{error}; the steps are judged with the scenario of the run") from None
    facts = Facts(diagnosis, steps, scenario)
    for line in full(facts, suggestions(facts), message):
        say(line)
    if figure:
        from ...plots.steps import draw_steps
        from ...plots.style import save_figure

        try:
            say(f"figure in {save_figure(lambda: draw_steps(steps, scenario.name), figure)}")
        except OSError as error:
            raise MistakeError(
                f"--figure {figure}: cannot be written ({error.strerror}); choose another"
            ) from None


def _do_steps(summary: Path) -> int | None:
    """As the run's summary says, if it does."""
    try:
        found = json.loads(summary.read_text("utf-8")).get("do_steps")
    except (OSError, ValueError):
        return None
    return int(found) if isinstance(found, int) else None
