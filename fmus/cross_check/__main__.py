"""`python -m fmus.cross_check [NAMES]` computes reference results anew and writes them beside their FMUs."""

from __future__ import annotations

import sys

from ..build import NAMES
from .inside import reference_folder
from .reference import results
from .stimulus import load_stimulus


def main(names: list[str]) -> None:
    """Write the files of these FMUs; of all that have a stimulus without names."""
    for name in names or NAMES:
        stimulus = load_stimulus(name)
        if stimulus is None:
            print(f"{name}: has no stimulus.py: nothing to compute")
            continue
        found = results(name, stimulus)
        for path, text in found.files.items():
            target = reference_folder(name) / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
        worst = max(found.stepped, key=lambda output: found.stepped[output])
        print(
            f"{name}: second solver within {max(found.uncertainty.values()):.0e}, component's steps within "
            f"{found.stepped[worst]:.0e} ({worst}), stated {found.tolerance:.0e}"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
