"""Published sources reproduced: their figures drawn, and every quantitative statement checked.

To add one: a module with `reproduce(folder, overwrite, reporter)`, listed here.
"""

from __future__ import annotations

SOURCES = ("kushwaha2000",)
