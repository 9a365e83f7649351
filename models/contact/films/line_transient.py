"""The film from the transient numerical solution (`contact.line`); as a formula, its steady estimate.

This is what the contact starts from and what it shows as steady film; the film itself is solved for.
"""

from __future__ import annotations

from .moes_venner import film

__all__ = ["film"]
