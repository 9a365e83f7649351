"""The cache of built FMUs: what is used stays, what was not for weeks goes."""

import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import models
from fmus.build import build, collect_files, pack_files
from models.compile.cache_eviction import KEPT_DAYS
from models.contact.ehl_line_contact import ehl_line_contact
from tests.models.stepped import Stepped

from ..aged import aged
from .conftest import clean_environment
from .reference import Reference

NOTES = {".note", ".built"}  # of what was asked for, and of what was built here


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("TRIBOCOSIM_CACHE", str(tmp_path))
    return tmp_path / "fmus"


def test_what_was_not_asked_for_goes_when_another_fmu_is_added(cache):
    used, unused = build("coupled_mass"), build("spring_stop")
    for file in (used, unused):
        aged(file, KEPT_DAYS + 1)
    rest = aged(cache / ".camshaft-rest.part", KEPT_DAYS + 1)
    young = [aged(cache / "other-0.fmu", KEPT_DAYS - 1), aged(cache / ".camshaft-now.part", 0.0)]
    foreign = aged(cache / "notes.txt", 1000.0)
    assert build("coupled_mass") == used  # asked for again
    added = build("falling_mass")
    assert {file for file in cache.iterdir() if file.suffix not in NOTES} == {used, added, foreign, *young}
    assert not rest.exists()


def test_a_deleted_fmu_is_built_again(cache):
    file = build("coupled_mass")
    content = file.read_bytes()
    file.unlink()
    assert build("coupled_mass").read_bytes() == content


@pytest.mark.parametrize("damage", [b"\0", b"", "half"])
@pytest.mark.parametrize("kind", ["fmu", "note", "built"])
def test_a_damaged_file_is_built_again(damage, kind, cache):
    """As a power cut leaves it: zeroed, empty or cut."""
    file = build("coupled_mass")
    content = file.read_bytes()
    for damaged in cache.glob(f"*.{kind}"):
        whole = damaged.read_bytes()
        damaged.write_bytes(whole[: len(whole) // 2] if isinstance(damage, str) else damage * len(whole))
    assert build("coupled_mass").read_bytes() == content


def test_a_note_leads_to_no_file_elsewhere(cache):
    file = build("coupled_mass")
    (cache.parent / "other.fmu").write_bytes(file.read_bytes())
    for note in cache.glob("*.note"):
        note.write_text("../other.fmu")
    assert build("coupled_mass") == file


def test_a_known_fmu_is_found_by_its_note_until_a_source_changes(cache, monkeypatch):
    file = build("coupled_mass")
    packed: list[str] = []

    def collect_files(name, *rest):
        packed.append(name)
        return {"modelDescription.xml": b"other"}

    monkeypatch.setattr("fmus.build.collect_files", collect_files)
    assert build("coupled_mass") == file
    assert not packed
    monkeypatch.setattr("fmus.fmu_cache._sources", lambda: "edited")
    assert build("coupled_mass") != file
    assert packed == ["coupled_mass"]


RUN = """
slave = Instance({fmu!r}).initialize(force=5.0)
for i in range(50):
    slave.step(i * 1e-5, 1e-5)
result = slave.outputs()
slave.free()
"""


def reference_outputs() -> list[float]:
    reference = Reference("sprung_mass")
    reference.set_inputs({"force": 5.0})
    for i in range(50):
        reference.t = i * 1e-5
        reference.step(1e-5)
    return reference.outputs()


def test_two_versions_in_one_process(fmu_files, isolated, tmp_path, monkeypatch):
    """The second version has a lift twice as large; each instance runs its own code."""
    first, source = fmu_files["valve_spring"], Path(models.__file__).parent
    changed = shutil.copytree(source, tmp_path / "changed" / "models")
    file = changed / "valve_train" / "valve_spring.py"
    text = file.read_text()
    line = "y.valve_lift = x.position - p.lash"
    assert line in text
    file.write_text(text.replace(line, "y.valve_lift = 2.0 * (x.position - p.lash)"))
    monkeypatch.setattr(models, "__file__", str(changed / "__init__.py"))
    monkeypatch.setattr("fmus.fmu_cache._sources", lambda: "changed")
    second = build("valve_spring", tmp_path / "second.fmu")
    code = f"""
    one, two = Instance({str(first)!r}, "one"), Instance({str(second)!r}, "two")
    found = []
    for slave in (one, two):
        slave.initialize(position_start=1e-3)
        found.append(slave.get(["valve_lift", "position"]))
    report([found, one.description.guid != two.description.guid])
    """
    assert isolated(code, "numba") == [[[1e-3, 1e-3], [2e-3, 1e-3]], True]


def test_twenty_instances(fmu_files, isolated):
    """Stepped in turns they give what each gives alone, and the interpreter's path does not grow."""
    code = f"""
    import sys
    slaves = [Instance({str(fmu_files["sprung_mass"])!r}, str(i)) for i in range(20)]
    entries = len(sys.path)
    for i, slave in enumerate(slaves):
        slave.initialize(force=4.0 + i)
    for step in range(30):
        for slave in slaves:
            slave.step(step * 1e-5, 1e-5)
    together = [slave.outputs() for slave in slaves]
    alone = []
    for i, slave in enumerate(slaves):
        slave.fmu.reset()
        slave.initialize(force=4.0 + i)
        for step in range(30):
            slave.step(step * 1e-5, 1e-5)
        alone.append(slave.outputs())
    for slave in slaves:
        slave.free()
    Instance({str(fmu_files["sprung_mass"])!r})
    report([together == alone, len(set(map(tuple, alone))), len(sys.path) - entries])
    """
    assert isolated(code) == [True, 20, 0]


def test_without_numba(fmu_files, isolated):
    """The same physics from the plain functions; rounding differs where the compiler contracts operations."""
    code = RUN.format(fmu=str(fmu_files["sprung_mass"])) + "report(result)"
    assert isolated(code, "numba", "llvmlite") == pytest.approx(reference_outputs(), rel=1e-9, abs=1e-12)


def test_without_numpy_it_says_so(fmu_files, isolated):
    code = f"""
    import contextlib, io, sys
    from fmpy.fmi2 import FMU2Slave

    instantiate = FMU2Slave.instantiate

    def without_numpy(self, **options):
        sys.modules["numpy"] = None  # fmpy itself needed it until now
        instantiate(self, **options)

    FMU2Slave.instantiate = without_numpy
    with contextlib.redirect_stderr(io.StringIO()) as said:
        try:
            Instance({str(fmu_files["flywheel"])!r})
        except Exception as error:
            print(error)
    report(said.getvalue())
    """
    assert "has no numpy; install it there" in isolated(code)


def test_second_start_compiles_nothing(fmu_files, isolated, tmp_path):
    """In another process, unpacked elsewhere: the compiled code on disk is used and none is added."""
    cache = tmp_path / "cache"
    code = RUN.format(fmu=str(fmu_files["sprung_mass"])) + "report(slave.folder)"

    def compiled():
        return {str(file): file.stat().st_mtime_ns for file in cache.rglob("*.nb?")}

    first = isolated(code, TRIBOCOSIM_CACHE=str(cache))
    after_first = compiled()
    second = isolated(code, TRIBOCOSIM_CACHE=str(cache))
    assert first != second
    assert len(after_first) > 0
    assert compiled() == after_first


@pytest.mark.parametrize(
    "obstacle", ["no folder can be made", pytest.param("no file can be written", marks=pytest.mark.long)]
)
def test_cache_that_cannot_be_written(obstacle, fmu_files, isolated, tmp_path):
    """Everything works, only slower to start."""
    place = tmp_path / "cache"
    if obstacle == "no folder can be made":
        place.write_text("a file where a folder should be")
    code = RUN.format(fmu=str(fmu_files["sprung_mass"])) + "report(result)"
    if obstacle == "no file can be written":
        limit = "; import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)); slave.initialize("
        code = code.replace(".initialize(", limit)
    assert isolated(code, TRIBOCOSIM_CACHE=str(place)) == reference_outputs()


BUILD = "from fmus.build import build; print(build('flywheel'))"


def test_same_sources_same_bytes():
    environment = clean_environment({"PYTHONHASHSEED": "1"})
    code = "import sys, fmus.build as b; sys.stdout.buffer.write(b.pack_files(b.collect_files('flywheel')))"
    other = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=True)
    assert other.stdout == pack_files(collect_files("flywheel"))


def test_builds_at_the_same_time(tmp_path):
    """Two processes build into one cache; both get the whole file, and a third finds it there."""
    environment = clean_environment({"TRIBOCOSIM_CACHE": str(tmp_path)})

    def start():
        return subprocess.Popen(
            [sys.executable, "-c", BUILD], env=environment, stdout=subprocess.PIPE, text=True
        )

    racing = [start(), start()]
    paths = {process.communicate()[0].strip() for process in racing}
    assert len(paths) == 1
    path = Path(paths.pop())
    assert zipfile.ZipFile(path).testzip() is None
    made = path.stat().st_ino
    start().communicate()
    assert path.stat().st_ino == made  # only its time is renewed
    assert [file.name for file in path.parent.glob("*.fmu")] == [path.name]


def test_build_leaves_no_trace_in_the_process(tmp_path):
    before, path = set(sys.modules), list(sys.path)
    build("camshaft", tmp_path)
    assert sys.path == path
    added = {
        name for name in set(sys.modules) - before if not name.startswith(("fmus.", "models.", "markdown_it"))
    }
    assert not {name for name in added if "tribocosim" in name or "camshaft" in name}


@pytest.mark.parametrize(
    ("sizes", "parameters", "sliding", "seen"),
    [
        ({"nodes": 101, "mass_conserving": 1}, {"oil_supply": 0.4e-6}, 0.0, "minimum_film_thickness"),
        ({"nodes": 101, "layers": 8}, {"eyring_stress": 5e6}, 2.0, "film_temperature"),
    ],
    ids=["cavities keep their oil", "the film is heated"],
)
def test_a_solved_film_with_more_than_pressure_runs_alone(
    sizes, parameters, sliding, seen, isolated, tmp_path
):
    """Entrainment reverses: as in this process."""
    path = build("ehl_line_contact", tmp_path / "contact.fmu", sizes, references=False)
    inputs = {"approach": 0.3e-6, "entraining_velocity": 1.0, "radius_of_curvature": 0.02}
    inputs["sliding_velocity"] = sliding
    code = f"""
    slave = Instance({str(path)!r}).initialize(**{parameters | inputs})
    for i in range(40):
        slave.set({{"entraining_velocity": 1.0 - i / 20.0}})
        slave.step(i * 2e-5, 2e-5)
    report(slave.get(["load", {seen!r}]))
    """
    alone = Stepped(ehl_line_contact(**sizes), parameters, inputs=inputs)
    for i in range(40):
        alone.input("entraining_velocity", 1.0 - i / 20.0)
        alone.advance(2e-5)
    found = isolated(code)
    assert found == pytest.approx([alone["load"], alone[seen]], rel=1e-9)
