"""A published source: what is computed for it, judged, drawn and written."""

import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Generic

from matplotlib.figure import Figure
from PIL import Image

from orchestrator.plots.style import save_figure
from orchestrator.reporter import Reporter
from orchestrator.store.output_folder import OutputFolderError

from .statement import Claim, Runs, Statement, Verdict

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


def format_statements(statements: Sequence[Statement]) -> str:
    """The Markdown table, with columns for the corrected form where a statement has it."""
    both = any(s.corrected for s in statements)
    headings = TWO_FORMS if both else HEADINGS
    rows = [headings, ["---"] * len(headings)]
    for s in statements:
        right = [s.corrected, f"**{s.corrected_verdict}**" if s.corrected_verdict else ""] if both else []
        cells = [s.place, s.text, s.computed, f"**{s.verdict}**", *right, s.reason]
        rows.append([cell.replace("|", "\\|") for cell in cells])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


JSON, FIGURES = "statements.json", "figures"
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
        """Draw, check and write everything into `folder`.

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
        plain = json.dumps([asdict(s) for s in statements], indent=2, ensure_ascii=False)
        (folder / JSON).write_text(plain + "\n", "utf-8")
        (folder / self.page_name).write_text(self.format_page(runs, statements), "utf-8")
        reporter.line(count_verdicts(statements))
        reporter.line(f"results in {folder}: {self.page_name}, {JSON}, {len(self.figures)} in {FIGURES}")

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
        names = (self.page_name, JSON, *(f"{FIGURES}/{figure.file}" for figure in self.figures))
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
