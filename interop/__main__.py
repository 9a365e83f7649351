"""`python -m interop [TOOL ...] [--fmu NAME ...] [--install]` runs our FMUs in other tools.

Without names every tool that is here. With --install each of them gets an environment of its own first.
With --fmu only these FMUs; what docs/tools.md has of others, and of other tools, stays.
"""

from __future__ import annotations

import argparse
import sys
import time

from fmus.build import NAMES as FMUS
from fmus.native.machine_code import NativeBuildError

from .document import FILE, Section, here, text, written
from .plan import KINDS, compared
from .running import NAMES, install, missing

RUNS = 4  # of which the best is told


def main() -> int:
    """0 if every tool that was named could be run."""
    parser = argparse.ArgumentParser(prog="python -m interop", description=__doc__)
    parser.add_argument("tools", nargs="*", metavar="TOOL", help=f"of {', '.join(NAMES)}")
    parser.add_argument("--fmu", nargs="+", choices=FMUS, metavar="NAME", help="only these FMUs")
    parser.add_argument("--install", action="store_true", help="into an environment of the tool's own")
    given = parser.parse_args()
    if unknown := [name for name in given.tools if name not in NAMES]:
        parser.error(f"no tool {unknown[0]!r}: there are {', '.join(NAMES)}")
    sections, absent = written(), []
    for name in given.tools or NAMES:
        if given.install and not install(name):
            print(f"{name}: could not be installed")
            absent.append(name)
            continue
        if why := missing(name):
            print(why)
            absent.append(name)
            continue
        kept = sections.get(name) if given.fmu else None
        sections[name] = kept or Section(name, "", here())
        for fmu in given.fmu or FMUS:
            run(sections[name], fmu)
        FILE.write_text(text(sections), "utf-8")
    return 1 if given.tools and absent else 0


def run(section: Section, fmu: str) -> None:
    """Every kind of this FMU in the section's tool."""
    for name, kind in KINDS.items():
        began = time.perf_counter()
        difference, answer = compared(section.tool, fmu, kind, RUNS)
        told = " ".join(section.note(fmu, name, difference, answer))
        passed = time.perf_counter() - began
        print(f"{section.tool}: {fmu}, {kind.title}: {told} {answer.failed} ({passed:.1f} s)", flush=True)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except NativeBuildError as error:
        sys.exit(f"{error}; or set up what the tests need: pip install -e '.[dev]'")
