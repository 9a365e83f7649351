"""A published source: what is computed for it, judged, drawn and written."""

import csv
import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Generic

from matplotlib.figure import Figure
from PIL import Image
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from orchestrator.plots.style import save_figure
from orchestrator.reporter import Reporter
from orchestrator.store.output_folder import OutputFolderError

from .statement import Claim, Runs, Statement, Verdict

STYLES = {
    Verdict.MET: "green",
    Verdict.NOT_MET: "yellow",
    Verdict.CANNOT: "red",
    Verdict.UNCHECKED: "magenta",
}
HEADINGS = ["Place", "Statement", "Computed", "Verdict", "Reason"]
# Of a source whose own model and the corrected one are judged side by side.
TWO_FORMS = ["Place", "Statement", "As published", "Verdict", "Corrected", "Corrected verdict", "Reason"]


def count_verdicts(statements: Sequence[Statement]) -> str:
    """How many statements have each verdict."""
    text = f"{len(statements)} statements: {_count(s.verdict for s in statements)}"
    second = [s.corrected_verdict for s in statements if s.corrected_verdict]
    if second:
        text += f"; of the {len(second)} that depend on the form, corrected: {_count(second)}"
    return text


def _count(verdicts: Iterable[Verdict]) -> str:
    count = Counter(verdicts)
    return ", ".join(f"{count[verdict]} {verdict}" for verdict in Verdict if count[verdict])


def tabulate(statements: Sequence[Statement]) -> list[list[str]]:
    """Headings and rows; with columns for the corrected form where a statement has it."""
    if any(s.corrected for s in statements):
        right = [[s.corrected, s.corrected_verdict or ""] for s in statements]
        headings = TWO_FORMS
    else:
        right, headings = [[] for _ in statements], HEADINGS
    pairs = zip(statements, right, strict=True)
    return [headings, *([s.place, s.text, s.computed, s.verdict, *more, s.reason] for s, more in pairs)]


def print_table(statements: Sequence[Statement], console: Console) -> None:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_lines=True)
    for name, ratio in zip(HEADINGS[:3], (2, 6, 9), strict=True):
        table.add_column(name.lower(), ratio=ratio, overflow="fold")
    table.add_column("verdict", ratio=2)
    for s in statements:
        computed, verdict = Text(s.computed), Text(s.verdict, STYLES[s.verdict])
        if s.corrected:
            computed.append(f"\ncorrected: {s.corrected}")
        if s.corrected_verdict:
            verdict.append(f"\n{s.corrected_verdict}", STYLES[s.corrected_verdict])
        if s.reason:
            computed.append(f"\n{s.reason}", style="dim")
        table.add_row(Text(s.place), Text(s.text), computed, verdict)
    console.print(table)


def write_csv(rows: Iterable[Sequence[str]], path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(rows)


def write_statements(statements: Sequence[Statement], csv_path: Path, json_path: Path) -> None:
    headings, *rows = tabulate(statements)
    keyed = ([s.key, *row] for s, row in zip(statements, rows, strict=True))
    write_csv([["key", *(name.lower() for name in headings)], *keyed], csv_path)
    plain = json.dumps([asdict(s) for s in statements], indent=2, ensure_ascii=False)
    json_path.write_text(plain + "\n", "utf-8")


def format_statements(statements: Sequence[Statement]) -> str:
    """The Markdown table, verdicts in bold."""
    headings, *rows = tabulate(statements)
    bold = ["erdict" in name for name in headings]
    return format_table(
        headings,
        *(
            [f"**{s}**" if b and s else s.replace("|", "\\|") for s, b in zip(r, bold, strict=True)]
            for r in rows
        ),
    )


def format_table(headings: Sequence[str], *rows: Sequence[str]) -> str:
    """A Markdown table."""
    return "\n".join("| " + " | ".join(row) + " |" for row in (headings, ["---"] * len(headings), *rows))


CSV, JSON, FIGURES = "statements.csv", "statements.json", "figures"
# Line drawings lose nothing in so few colours, and the files are small enough for a repository.
PALETTE = 128


@dataclass(frozen=True)
class Drawing(Generic[Runs]):
    """A figure; the page shows those that have a caption."""

    file: str
    plot: Callable[[Runs], Figure]
    caption: str = ""
    dpi: float | None = None

    def save(self, runs: Runs, folder: Path) -> None:
        path = save_figure(lambda: self.plot(runs), folder / self.file, self.dpi)
        Image.open(path).convert("RGB").quantize(PALETTE).save(path, optimize=True)

    @property
    def markdown(self) -> str:
        return f"![{self.caption}]({FIGURES}/{self.file})\n"


@dataclass(frozen=True)
class Publication(Generic[Runs]):
    """`claims` are the source's statements, in its order. `sections` gives the parts of the Markdown page
    between the introduction and the statements.

    All work on one `runs()`, which computes what is asked for and keeps it. `solve` computes in advance what
    takes long, and yields the share that is done.
    """

    name: str
    runs: Callable[[], Runs]
    claims: Sequence[Claim[Runs]]
    figures: Sequence[Drawing[Runs]]
    introduction: str
    sections: Callable[[Runs], Sequence[str]]
    solve: Callable[[Runs], Iterator[float]] | None = None

    @property
    def page_name(self) -> str:
        return f"{self.name}.md"

    def reproduce(self, folder: Path, overwrite: bool = False) -> None:
        """Draw, check, print and write everything into `folder`.

        OutputFolderError, before anything is computed, where the folder cannot take it.
        """
        reporter = Reporter()
        self.prepare(folder, overwrite)
        runs = self.runs()
        if self.solve:
            with reporter.stage("solutions") as bar:
                for share in self.solve(runs):
                    bar.show(share)
        statements = []
        with reporter.stage("statements") as bar:
            for n, claim in enumerate(self.claims):
                statements.append(claim.judge(runs))
                bar.show((n + 1) / len(self.claims))
        with reporter.stage("figures"):
            self.draw(runs, folder / FIGURES)
        write_statements(statements, folder / CSV, folder / JSON)
        (folder / self.page_name).write_text(self.format_page(runs, statements), "utf-8")
        print_table(statements, reporter.console)
        reporter.line(count_verdicts(statements))
        reporter.line(
            f"results in {folder}: {self.page_name}, {CSV}, {JSON}, {len(self.figures)} in {FIGURES}"
        )

    def draw(self, runs: Runs, folder: Path) -> None:
        """All figures."""
        for figure in self.figures:
            figure.save(runs, folder)

    def format_page(self, runs: Runs, statements: Sequence[Statement]) -> str:
        """The Markdown page."""
        parts = [self.introduction, *self.sections(runs), "## Statements\n"]
        parts += [f"{count_verdicts(statements)}.\n", format_statements(statements), ""]
        return "\n".join(parts)

    def prepare(self, folder: Path, overwrite: bool) -> None:
        """Make the folder; a reproduction in it, or a part of one, is refused unless `overwrite`."""
        if folder.exists() and not folder.is_dir():
            raise OutputFolderError(f"{folder}: is a file; choose a folder with --out")
        names = (self.page_name, CSV, JSON, *(f"{FIGURES}/{figure.file}" for figure in self.figures))
        held = [folder / name for name in names if (folder / name).exists()]
        if held and not overwrite:
            raise OutputFolderError(
                f"{folder}: already holds a result ({held[0].relative_to(folder)}); choose another folder "
                "with --out, or replace it with --overwrite"
            )
        try:
            for file in held:
                file.unlink()
            (folder / FIGURES).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputFolderError(
                f"{folder}: cannot be written ({error.strerror}); choose another --out"
            ) from None
