"""What judges a statement."""

from __future__ import annotations

from collections.abc import Callable

from ...statement import Statement
from ..runs import Runs

Check = Callable[[Runs], Statement]
