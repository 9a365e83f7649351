"""The figures of a run and its page: at its end, and drawn anew from its folder."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import Command, ExplainedError, RunError, Words
from ..plots import KINDS, draw_figure
from ..plots.data import FigureData
from ..store.output_folder import FIGURES, REPORT, STORE, format_path
from ..store.result_file import find_result
from .page import write_report


def draw_anew(folder: Path, path: Path | None = None) -> Path:
    """Write the page of a run, or a sweep over speed, to `path`; or draw all that the run's folder has.

    The page's path. RunError names what failed, once all else is drawn.
    """
    if path or (folder / STORE).exists():
        return write_report(folder, path)
    if told := draw_pictures(folder):
        raise RunError(tuple(("\n" * (i > 0), line) for i, line in enumerate(told)))
    return folder / REPORT


def draw_pictures(folder: Path, figures: bool = True) -> list[Words]:
    """Draw the figures of the run in `folder` and write its page; a line for each that failed.

    MistakeError if there is no result.
    """
    find_result(folder)
    again = Command("report", (format_path(folder),))
    told: list[Words] = []

    @contextmanager
    def telling(what: str) -> Iterator[None]:
        try:
            yield
        except Exception as error:  # the run has all of its numbers
            known = isinstance(error, ExplainedError | OSError)
            said = error if isinstance(error, ExplainedError) else str(error)
            why = said if known else f"unexpected {type(error).__name__}: {said}"
            told.append((f"no {what}: ", why, "; once that is mended, ", again, " draws it anew"))

    if figures:
        with telling("figures"):
            data = FigureData.read(folder)
            for name in KINDS if len(data.time) > 1 else ():
                with telling(f"figure {name}"):
                    draw_figure(name, data, folder / FIGURES)
    with telling("report"):
        write_report(folder)
    return told
