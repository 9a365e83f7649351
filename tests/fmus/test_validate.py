"""Files that are no FMU, or no safe one, and libraries that are no whole ones, are named in one line."""

import contextlib
import hashlib
import random
import re
import shutil
import struct
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path

import fmpy
import pytest

import tribocosim
from fmus.binaries import functions, library_fault
from fmus.build import NAMES
from fmus.fmi.libraries import LibraryError, libraries
from fmus.fmi.origin import is_built_here
from fmus.fmi.validate import Findings, FmuFileError, info, inspect, validate
from fmus.reference_results.compare import compare
from fmus.reference_results.files import ComparisonError

from ..archives import rename_files, repack
from .names import mark_long

XML = "modelDescription.xml"


def archive_of(path: Path, files: dict[str, str]) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return path


@pytest.mark.parametrize("name", mark_long(NAMES))
def test_our_own_are_valid(name, fmu_files):
    path = fmu_files[name]
    assert validate(path) == []
    found = info(path)
    assert (found.name, found.fmi_version, found.kinds) == (name, "2.0", ("co-simulation",))
    assert "canGetAndSetFMUstate" in found.capabilities
    assert found.digest == hashlib.sha256(path.read_bytes()).hexdigest()
    assert {"linux64", "win64"} <= set(found.platforms)
    assert "stored_energy" in [v.name for v in found.variables]


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"../evil": "", XML: ""}, "leaves the archive"),
        ({"C:/evil": "", XML: ""}, "leaves the archive"),
        ({"a\\b": "", XML: ""}, "backslash"),
        ({"README": ""}, "is missing, so this is not an FMU"),
        ({XML: "not xml"}, "not XML"),
        ({XML: "<html/>"}, "is not a model description"),
        ({XML: '<fmiModelDescription fmiVersion="7.1"/>'}, "must be 1.0, 2.0 or 3.x"),
        ({XML: '<fmiModelDescription fmiVersion="2.0"/>'}, "'modelName' is required"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(files, message, tmp_path):
    faults = validate(archive_of(tmp_path / "foreign.fmu", files))
    assert faults
    assert message in faults[0]
    assert all("\n" not in fault for fault in faults)


_OLD, _TWO, _THREE = (
    'modelIdentifier="m"><ModelVariables><ScalarVariable name="y"/></ModelVariables>',
    'guid="g"><ModelVariables><ScalarVariable name="y"/></ModelVariables>',
    'instantiationToken="g"><ModelVariables><Float64 name="y"/></ModelVariables>',
)


@pytest.mark.parametrize(
    ("said", "content", "written"),
    [("3.0", _TWO, "2.0"), ("1.0", _TWO, "2.0"), ("2.0", _THREE, "3.0"), ("2.0", _OLD, "1.0")],
)
def test_a_version_that_the_description_is_not_written_in_is_named(said, content, written, tmp_path):
    xml = f'<fmiModelDescription fmiVersion="{said}" modelName="m" {content}</fmiModelDescription>'
    path = archive_of(tmp_path / "foreign.fmu", {XML: xml})
    words = f"says fmiVersion = '{said}', but is written as FMI {written} has it"
    assert [words in fault for fault in validate(path)] == [True]
    with pytest.raises(FmuFileError, match=words):
        info(path)
    with pytest.raises(ComparisonError, match=words) as refused:
        compare(path)
    assert str(path) in str(refused.value)


def test_an_fmu_of_fmi_1_is_not_compared(tmp_path):
    xml = (
        '<fmiModelDescription fmiVersion="1.0" modelName="m" modelIdentifier="m" guid="g" '
        'numberOfContinuousStates="0" numberOfEventIndicators="0"><ModelVariables/></fmiModelDescription>'
    )
    path = archive_of(tmp_path / "old.fmu", {XML: xml})
    with pytest.raises(ComparisonError, match=r"is of FMI 1\.0, which is not run here"):
        compare(path)


def test_not_an_archive(tmp_path):
    text = tmp_path / "text.fmu"
    text.write_text("hello")
    assert "not a zip archive" in validate(text)[0]
    assert "no such file" in validate(tmp_path / "nothing.fmu")[0]
    with pytest.raises(FmuFileError, match="not a zip archive"):
        info(text)


@pytest.mark.parametrize(
    ("mode", "said"),
    [
        (0o120777, "symbolic link"),
        (0o010644, "named pipe"),
        (0o020644, "device"),
        (0o060644, "device"),
        (0o140644, "socket"),
        (0o104755, "rights of its owner"),
        (0o102755, "rights of its owner"),
    ],
)
@pytest.mark.parametrize("name", ["binaries/entry", "binaries/entry/"])
def test_entries_that_are_no_plain_files_are_refused(mode, said, name, tmp_path):
    entry = zipfile.ZipInfo(name)
    entry.external_attr = mode << 16
    path = tmp_path / "link.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(entry, "/etc/passwd")
    assert said in validate(path)[0]


def test_damage_anywhere_is_found(fmu_files, tmp_path):
    """One changed byte in the middle of any file of the archive, and a file that ends early."""
    good = fmu_files["flywheel"].read_bytes()
    damaged = tmp_path / "damaged.fmu"
    with zipfile.ZipFile(fmu_files["flywheel"]) as archive:
        entries = [entry for entry in archive.infolist() if entry.file_size]
    for entry in entries:
        place = entry.header_offset + 30 + len(entry.filename) + entry.compress_size // 2
        damaged.write_bytes(good[:place] + bytes([good[place] ^ 0xFF]) + good[place + 1 :])
        assert "damaged archive" in validate(damaged)[0], entry.filename
    damaged.write_bytes(good[: len(good) // 2])
    assert "is cut off: it begins as a zip archive" in validate(damaged)[0]


def test_a_library_of_another_name_is_named(fmu_files, tmp_path):
    """On one platform of several: nobody there can load it."""
    renamed = tmp_path / "renamed.fmu"
    rename_files(fmu_files["flywheel"], renamed, "linux64/flywheel.", "linux64/wheel.")
    lines = ["binaries/linux64: none is called flywheel, the model identifier, but wheel"]
    assert validate(renamed) == lines
    here = fmpy.platform == "linux64"
    assert inspect(renamed) == (Findings(lines, []) if here else Findings([], lines))


def test_a_library_of_another_platform_keeps_nobody_here_from_running(fmu_files, tmp_path):
    renamed = tmp_path / "renamed.fmu"
    rename_files(fmu_files["flywheel"], renamed, "win64/flywheel.", "win64/wheel.")
    found = tribocosim.validate_fmu(renamed)
    assert (len(found.faults), len(found.remarks)) == (int(fmpy.platform == "win64"), 1 - len(found.faults))
    assert not tribocosim.validate_fmu(fmu_files["flywheel"])
    assert str(tribocosim.validate_fmu(fmu_files["flywheel"])) == "no problems found"


def test_tables_of_an_fmu_are_a_line_each_after_the_scalars(fmu_files, monkeypatch):
    info = tribocosim.fmu_info(fmu_files["flywheel"])
    scalar = info.variables[0]
    points = [replace(scalar, name=f"angles[{i}]", start=str(i)) for i in range(1, 362)]
    pair = [replace(scalar, name=f"coil[{i}]") for i in (1, 2)]
    monkeypatch.setenv("COLUMNS", "200")
    lines = str(replace(info, variables=(*points, *pair, scalar))).splitlines()[-4:]
    assert [line.split()[0] for line in lines] == ["coil[1]", "coil[2]", scalar.name, "angles[1..361]"]
    assert "1 ... 361" in lines[-1]
    monkeypatch.setenv("COLUMNS", "100")
    lines = [line for line in str(tribocosim.fmu_info(fmu_files["camshaft"])).splitlines() if line]
    assert max(map(len, lines)) <= 100
    assert any(line.split()[0] == "law" and line.split()[-1] == "0..6" for line in lines)


def test_it_agrees_with_its_reference_from_python(referenced):
    assert tribocosim.fmu_info(referenced["flywheel"]).name == "flywheel"
    assert tribocosim.compare_fmu(referenced["flywheel"]).agrees
    with pytest.raises(tribocosim.MistakeError, match="not a zip archive"):
        tribocosim.compare_fmu(__file__)


def test_only_what_was_built_here_is_known(fmu_files, tmp_path):
    """Neither a changed file, nor the same files packed again, nor one that says that tribocosim made it."""
    path, other = fmu_files["flywheel"], tmp_path / "other.fmu"
    assert is_built_here(path)
    other.write_bytes(path.read_bytes())
    assert is_built_here(other)
    repack(path, other, lambda name, content: {name: content})
    assert not is_built_here(other)
    with zipfile.ZipFile(other, "a") as target:
        target.writestr("resources/new.txt", b"")
    assert not is_built_here(other)


def test_binary_and_ranges(fmu_files, tmp_path):
    """A start value outside its range, and no binary of the declared name."""
    with zipfile.ZipFile(fmu_files["flywheel"]) as archive:
        xml = archive.read(XML).decode()
    broken = xml.replace('min="0.0" nominal="0.1" start="0.1"', 'min="0.0" nominal="0.1" start="-0.1"')
    assert broken != xml
    faults = validate(archive_of(tmp_path / "broken.fmu", {XML: broken}))
    assert "binaries: none is called flywheel, the model identifier" in faults
    assert "inertia: start = -0.1 is outside [0, inf]" in faults


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
