"""FMUs in Python, native ones of FMI 2 and of FMI 3: how tests make and host those of each kind."""

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

import pytest

from fmus.build import NAMES, build
from fmus.native.fmu import NAMES as NATIVE_NAMES
from fmus.native.fmu import build as build_native
from fmus.native.machine_code import this_platform
from tests.shared import made_once

from .instance import Instance, Instance3
from .names import mark_long


class Made(dict[str, Path]):
    """Files or folders by name, each made when it is first asked for."""

    def __init__(self, make: Callable[[str], Path]) -> None:
        super().__init__()
        self.make = make

    def __missing__(self, name: str) -> Path:
        self[name] = self.make(name)
        return self[name]


def made_files(kind: str, make: Callable[[str, Path], object]) -> Made:
    """Files that `make(name, folder)` leaves in a folder, each made once for all processes."""
    return Made(lambda name: next(made_once(f"{kind}-{name}", lambda f: make(name, f)).iterdir()))


HOSTS = {"python": Instance, "native": Instance, "native3": Instance3}


def build_kind(kind: str, name: str, folder: Path | None = None) -> Path:
    """The FMU as a file; with its reference results where a folder is given."""
    if kind == "python":
        return build(name, folder)
    return build_native(name, folder, platforms=[this_platform()], fmi=3 if kind == "native3" else 2)


# By kind and name.
FILES = {kind: Made(partial(build_kind, kind)) for kind in HOSTS}
WITH_REFERENCES = {kind: made_files(f"referenced-{kind}", partial(build_kind, kind)) for kind in HOSTS}


def every_fmu(
    names: Iterable[str] = NAMES, kinds: Iterable[str] = tuple(HOSTS), **always: Iterable[str]
) -> list:
    """Kind and name of every FMU of these components, as parameters of a test; those that are not `always`
    made of their kind are long."""
    pairs = [(k, n) for k in kinds for n in names if k == "python" or n in NATIVE_NAMES]
    return [
        pytest.param(kind, name, marks=() if name in always.get(kind, ()) else pytest.mark.long)
        for kind, name in pairs
    ]


# Native FMUs that are made in every run of the tests, with vectors and rates; machine code of impacts and of
# the contact takes long.
FAST = ("valve_spring",)
EVERY_NATIVE = mark_long(NATIVE_NAMES, FAST)
