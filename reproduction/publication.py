"""A published source: what is computed for it, judged, drawn and written."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Generic

from matplotlib.figure import Figure
from PIL import Image

from orchestrator.plots.style import save_figure
from orchestrator.reporter import Reporter
from orchestrator.store.output_folder import OutputFolderError

from . import table
from .statement import Claim, Runs, Statement

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
class NumbersFile(Generic[Runs]):
    """A CSV file beside the figures, with the numbers that they show."""

    file: str
    rows: Callable[[Runs], list[list[str]]]

    def save(self, runs: Runs, folder: Path) -> None:
        table.write_csv(self.rows(runs), folder / self.file)


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
    figures: Sequence[Drawing[Runs] | NumbersFile[Runs]]
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
        table.write_statements(statements, folder / CSV, folder / JSON)
        (folder / self.page_name).write_text(self.format_page(runs, statements), "utf-8")
        table.print_table(statements, reporter.console)
        reporter.line(table.count_verdicts(statements))
        reporter.line(
            f"results in {folder}: {self.page_name}, {CSV}, {JSON}, {len(self.figures)} in {FIGURES}"
        )

    def draw(self, runs: Runs, folder: Path) -> None:
        """All figures, and the numbers of those that have many."""
        for figure in self.figures:
            figure.save(runs, folder)

    def format_page(self, runs: Runs, statements: Sequence[Statement]) -> str:
        """The Markdown page."""
        parts = [self.introduction, *self.sections(runs), "## Statements\n"]
        parts += [f"{table.count_verdicts(statements)}.\n", table.format_statements(statements), ""]
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
