"""The solved film over the whole speed range, coupled against monolithic: some minutes."""

from __future__ import annotations

from collections.abc import Iterator

from .line_in_loop import coupled
from .table import Row


def rows() -> Iterator[Row]:
    yield coupled("valve-train-ehl-sweep", "(idle to 3000)")
