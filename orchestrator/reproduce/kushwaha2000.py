"""`tribocosim reproduce kushwaha2000`: Figs 2 to 8 and every quantitative statement of the source.

Kushwaha, Rahnejat and Jin, "Valve-train dynamics: a simplified tribo-elasto-multi-body analysis", Proc.
Instn Mech. Engrs 214 K (2000).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..report import Reporter
from ..run import OutputFolderError
from . import figures, table
from .runs import Runs
from .statements import CHECKS, Statement

CSV, JSON, PAGE, FIGURES = "statements.csv", "statements.json", "kushwaha2000.md", "figures"

INTRODUCTION = """\
# Kushwaha, Rahnejat and Jin (2000), reproduced

*Valve-train dynamics: a simplified tribo-elasto-multi-body analysis*, Proc. Instn Mech. Engrs 214 K: Figs
2 to 8 drawn from the models of this project, and every quantitative statement of the paper with the
computed value and a verdict: *met*; *not met*; *cannot be met* where the statement contradicts the
paper's others, or the equation as printed has no sensible solution. No number here is typed in or tuned
to the paper's results. What the paper does not give (lift, preload, steel, lubricant, spring damping,
shaft) was chosen once; it is the parameter set `kushwaha2000`, the defaults of the components. Statements
about other authors' cams and measurements are left out.

All runs are the shipped scenario `valve-train` in adherence form (the follower held to the cam, as in the
paper), in the steady state. Speeds are those of the camshaft. The film follows (10) with its squeeze
term, read as the differential equation dh/dt = −(|u|/96.775) ln(h/h_ss). The load exponent of (10) is
+0.059 in print, where physics wants −0.059: both are shown where it matters, and the printed one is meant
where nothing is said.

This page and its figures are written by `tribocosim reproduce kushwaha2000 --out FOLDER`; after a change
of the models, copy `kushwaha2000.md` and `figures` from the folder to `docs`.
"""


def reproduce(folder: Path, overwrite: bool = False, reporter: Reporter | None = None) -> list[Statement]:
    """Draw, check, print and write everything into `folder`.

    OutputFolderError, before anything is computed, where the folder cannot take it.
    """
    reporter = reporter or Reporter()
    prepare(folder, overwrite)
    runs = Runs()
    statements = []
    with reporter.stage("statements") as bar:
        for n, check in enumerate(CHECKS):
            statements.append(check(runs))
            bar.show((n + 1) / len(CHECKS))
    with reporter.stage("figures"):
        drawn = figures.draw(runs, folder / FIGURES)
    table.write_csv(statements, folder / CSV)
    table.write_json(statements, folder / JSON)
    (folder / PAGE).write_text(page(statements), "utf-8")
    table.show(statements, reporter.console)
    reporter.line(table.tally(statements))
    names = (PAGE, CSV, JSON, *(str(path.relative_to(folder)) for path in drawn))
    reporter.line(f"results in {folder}: {', '.join(names)}")
    return statements


def prepare(folder: Path, overwrite: bool) -> None:
    """Make the folder; a reproduction in it is refused unless `overwrite`."""
    if folder.exists() and not folder.is_dir():
        raise OutputFolderError(f"{folder}: is a file; choose a folder with --out")
    held = [folder / name for name in (PAGE, CSV, JSON) if (folder / name).exists()]
    if held and not overwrite:
        raise OutputFolderError(
            f"{folder}: already holds a result ({held[0].name}); choose another folder with --out, "
            "or replace it with --overwrite"
        )
    try:
        for file in held:
            file.unlink()
        (folder / FIGURES).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputFolderError(
            f"{folder}: cannot be written ({error.strerror}); choose another --out"
        ) from None


def page(statements: Sequence[Statement]) -> str:
    """The Markdown page: introduction, figures, table."""
    parts = [INTRODUCTION, "## Figures\n"]
    for number, caption in figures.CAPTIONS.items():
        parts.append(f"![Fig. {number}: {caption}]({FIGURES}/{figures.PREFIX}{number}.png)\n")
    parts += ["## Statements\n", f"{table.tally(statements)}.\n", table.markdown(statements), ""]
    return "\n".join(parts)
