"""Published sources reproduced: their figures drawn, and every quantitative statement checked.

To add one: a module with a `Publication` named PUBLICATION, listed here.
"""

from importlib import import_module
from typing import Any

from .publication import Publication

SOURCES = ("farahanchi1991", "films", "kushwaha2000", "qin2000")


def load_publication(source: str) -> Publication[Any]:
    """The source of that name."""
    found: Publication[Any] = import_module(f".{source}", __package__).PUBLICATION
    return found
