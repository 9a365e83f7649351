"""A published source: what is computed for it, judged, drawn and written."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Generic

from orchestrator.reporter import Reporter
from orchestrator.store.output_folder import OutputFolderError

from . import table
from .statement import Claim, Runs, Statement

CSV, JSON, FIGURES = "statements.csv", "statements.json", "figures"


@dataclass(frozen=True)
class Publication(Generic[Runs]):
    """`claims` are the source's statements, in its order; `figures` are the files that `draw` makes.

    All of them work on one `runs()`, which computes what is asked for and keeps it. `solve` computes what
    takes long before they ask, and yields the share that is done.
    """

    name: str
    runs: Callable[[], Runs]
    claims: Sequence[Claim[Runs]]
    figures: Sequence[str]
    draw: Callable[[Runs, Path], list[Path]]
    page: Callable[[Runs, Sequence[Statement]], str]
    solve: Callable[[Runs], Iterator[float]] | None = None

    @property
    def page_name(self) -> str:
        return f"{self.name}.md"

    def reproduce(
        self, folder: Path, overwrite: bool = False, reporter: Reporter | None = None
    ) -> list[Statement]:
        """Draw, check, print and write everything into `folder`.

        OutputFolderError, before anything is computed, where the folder cannot take it.
        """
        reporter = reporter or Reporter()
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
            drawn = self.draw(runs, folder / FIGURES)
        table.write_csv(statements, folder / CSV)
        table.write_json(statements, folder / JSON)
        (folder / self.page_name).write_text(self.page(runs, statements), "utf-8")
        table.print_table(statements, reporter.console)
        reporter.line(table.count_verdicts(statements))
        reporter.line(f"results in {folder}: {self.page_name}, {CSV}, {JSON}, {len(drawn)} in {FIGURES}")
        return statements

    def prepare(self, folder: Path, overwrite: bool) -> None:
        """Make the folder; a reproduction in it, or a part of one, is refused unless `overwrite`."""
        if folder.exists() and not folder.is_dir():
            raise OutputFolderError(f"{folder}: is a file; choose a folder with --out")
        names = (self.page_name, CSV, JSON, *(f"{FIGURES}/{name}" for name in self.figures))
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
