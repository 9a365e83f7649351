"""`python -m fmus.cross_check [NAMES]` computes reference results anew and writes them beside their FMUs."""

from __future__ import annotations

import sys

from ..build import NAMES
from .inside import folder_of
from .reference import results
from .stimulus import course_of


def main(names: list[str]) -> None:
    """Write the files of these FMUs; of all that have a course without names."""
    for name in names or NAMES:
        course = course_of(name)
        if course is None:
            print(f"{name}: has no stimulus.py: nothing to compute")
            continue
        found = results(name, course)
        for path, text in found.files.items():
            target = folder_of(name) / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
        worst = max(found.stepped, key=lambda output: found.stepped[output])
        print(
            f"{name}: second solver within {max(found.uncertainty.values()):.0e}, component's steps within "
            f"{found.stepped[worst]:.0e} ({worst}), stated {found.tolerance:.0e}"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
