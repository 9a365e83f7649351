"""Libraries in FMUs that are cut off, or for another platform than their folder says, are found unloaded."""

import contextlib
import random
import re
import shutil
import struct
import subprocess
import zipfile
from pathlib import Path

import pytest

from fmus.binaries import functions, library_fault
from fmus.fmi.libraries import LibraryError, libraries
from fmus.fmi.validate import validate

from ..archives import repack


@pytest.fixture(scope="module")
def carried(fmu_files):
    """The libraries of an FMU that runs in Python, of Linux and Windows, by their folders."""
    with zipfile.ZipFile(fmu_files["flywheel"]) as archive:
        names = [name for name in archive.namelist() if name.endswith((".so", ".dll"))]
        return {Path(name).parent.name: archive.read(name) for name in names if name.startswith("binaries/")}


@pytest.mark.parametrize("folder", ["linux64", "win64"])
def test_of_a_library_that_is_cut_off_every_length_is_found(folder, carried):
    """What its tables tell of is less than the file by no more than what linkers add at its end."""
    whole = carried[folder]
    assert library_fault(whole, folder, functions(2, exchange=False)) == ""
    for part in (0.0, 0.001, 0.01, *(n / 20 for n in range(1, 20)), 0.99):
        assert "pack the FMU again" in library_fault(whole[: int(part * len(whole))], folder, frozenset())


@pytest.mark.parametrize(
    ("folder", "put_in", "is_for", "must"),
    [
        ("linux64", "win64", r"x86_64 \(ELF\)", r"x86_64 \(PE\)"),
        ("linux64", "aarch64-linux", r"x86_64 \(ELF\)", r"aarch64 \(ELF\)"),
        ("win64", "darwin64", r"x86_64 \(PE\)", r"x86_64 or aarch64 \(Mach-O\)"),
    ],
)
def test_one_in_the_folder_of_another_platform_is_named(
    folder, put_in, is_for, must, carried, fmu_files,
    tmp_path):  # fmt: skip
    def change(name, content):
        if name == "modelDescription.xml":
            return {name: content, f"binaries/{put_in}/flywheel.so": carried[folder]}
        return {} if name.startswith(f"binaries/{put_in}/") else {name: content}

    other = repack(fmu_files["flywheel"], tmp_path / "other.fmu", change)
    (fault,) = validate(other)
    said = rf"binaries/{put_in}/flywheel\.so: is for {is_for}: must be for {must}, by its folder's name"
    assert re.fullmatch(said, fault)


def test_functions_that_are_missing_are_named(carried):
    """Of another version of FMI none is there; of model exchange what it has besides."""
    every, missing = carried["linux64"], functions(2) - functions(2, exchange=False)
    assert len(missing) == 10
    said = library_fault(every, "linux64", functions(2))
    assert said.startswith(f"does not export {', '.join(sorted(missing)[:3])} and 7 more, which")
    assert "and 72 more" in library_fault(every, "linux64", functions(3))


def test_what_is_no_library_is_said(carried):
    whole = carried["linux64"]
    for content, said in (
        (b"", "no shared library of Linux, Windows or macOS"),
        (b"version https://git-lfs", "no shared library"),
        (whole[:16] + struct.pack("<H", 2) + whole[18:], "type 2: must be 3, a shared object"),
        (whole[:5] + b"\x02" + whole[6:], "highest byte"),
        (b"MZ" + bytes(100), "has no PE header"),
        (b"\xcf\xfa\xed\xfe" + struct.pack("<IIII", 0x01000007, 3, 2, 0), "type 2: must be 6"),
    ):
        with pytest.raises(LibraryError, match=said):
            libraries(content)


def test_a_universal_library_is_for_each_of_its_processors():
    """As Apple's tools put them together: a table of what follows, its numbers by the highest byte first."""
    kinds = {0x01000007: "x86_64", 0x0100000C: "aarch64"}
    parts = [b"\xcf\xfa\xed\xfe" + struct.pack("<IIII", kind, 0, 6, 0) + bytes(12) for kind in kinds]
    head, content = struct.pack(">II", 0xCAFEBABE, 2), b""
    for kind, part in zip(kinds, parts, strict=True):
        head += struct.pack(">IIIII", kind, 0, 48 + len(content), len(part), 0)
        content += part
    assert [one.processor for one in libraries(head + content)] == [*kinds.values()]
    assert library_fault(head + content, "aarch64-darwin", frozenset()) == ""
    with pytest.raises(LibraryError, match="is cut off"):
        libraries((head + content)[:-1])


@pytest.mark.parametrize("folder", ["linux64", "win64"])
def test_damaged_ones_raise_nothing_else(folder, carried):
    """Bytes of the header changed at random."""
    random_ones = random.Random(6)
    for _ in range(300):
        damaged = bytearray(carried[folder])
        for _ in range(random_ones.randint(1, 8)):
            damaged[random_ones.randrange(1024)] = random_ones.randrange(256)
        with contextlib.suppress(LibraryError):
            libraries(bytes(damaged))


def test_exports_are_those_of_another_reader(tmp_path, carried):
    if not (nm := shutil.which("nm")):
        pytest.skip("needs nm, of the binutils")
    file = tmp_path / "flywheel.so"
    file.write_bytes(carried["linux64"])
    told = subprocess.run([nm, "-D", "--defined-only", file], check=True, capture_output=True, text=True)
    names = {line.split()[-1].partition("@")[0] for line in told.stdout.splitlines()}
    assert libraries(carried["linux64"])[0].exports == names
