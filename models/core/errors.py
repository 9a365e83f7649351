"""What is raised where a model cannot be built or evaluated."""

from __future__ import annotations


class ModelError(ValueError):
    """A system that cannot be built or evaluated; the message names the thing and the remedy."""
