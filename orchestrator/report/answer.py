"""The page of a study: what its command answered in tables and sentences, its figures, and its files."""

import base64
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

from rich.table import Table

from models.core.remedies import Words, in_command_line

from ..reporter import Reporter
from .page import render, write_page


class Answer:
    """Tables and sentences at the end of a command. The reporter prints them at once; the page has all, and
    what the reporter was told to notice."""

    def __init__(self, title: str, reporter: Reporter) -> None:
        self._title, self._reporter = title, reporter
        self._said: list[str | Table] = []

    def table(self, table: Table) -> None:
        self._reporter.console.print(table)
        self._said.append(table)

    def line(self, text: Words) -> None:
        self._reporter.line(text)
        self._said.append(in_command_line(text))

    def write(self, folder: Path, page: str, files: Sequence[str]) -> None:
        """Write the page into `folder`, with the figures among the `files` there, and name all files.

        MistakeError if the page cannot be written.
        """
        figures = [
            (name, base64.b64encode((folder / name).read_bytes()).decode())
            for name in files
            if name.endswith(".png")
        ]
        said = [_list_cells(one) if isinstance(one, Table) else one for one in self._said]
        values = {"title": self._title, "said": said, "figures": figures, "files": files}
        values["notices"] = list(self._reporter.noticed)
        text = render("answer.html", version=metadata.version("tribocosim"), **values)
        write_page(text, folder / page)
        self._reporter.line(f"results in {folder}: {', '.join((page, *files))}")


def _list_cells(table: Table) -> dict[str, object]:
    heads = [str(column.header) for column in table.columns]
    rows = zip(*(map(str, column.cells) for column in table.columns), strict=True)
    return {"title": str(table.title or ""), "heads": heads, "rows": list(rows)}
