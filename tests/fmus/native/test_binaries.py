"""Machine code in native FMUs: small, of its platform and sources only; what cannot be made is said."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from fmus.binaries import functions, platform
from fmus.fmi.libraries import libraries
from fmus.fmi.validate import validate
from fmus.native.fmu import NAMES, build
from fmus.native.machine_code import PLATFORMS, WEBASSEMBLY, NativeBuildError, object_code
from models.native.translate import TranslationError, _summarise, translate
from tests.orchestrator.commands import called, said

from ..names import mark_long

# zig's linker exports where a library of macOS begins, under two names. Libraries there are searched one by
# one, so that names in several do no harm.
OF_THE_LINKER = frozenset({"_mh_dylib_header", "__dso_handle"})
# In bytes: the requirement on native FMUs. docs/theory/native-fmus.md names those that exceed it.
LIMIT = 200_000
LARGER = (
    "slider_crank", "piston_crank", "free_piston_crank", "ehl_contact", "journal_bearing", "pin_bearing",
)  # fmt: skip
LARGER_IN_FMI_3 = (*LARGER, "finger", "camshaft")


@pytest.mark.parametrize("fmi", mark_long([2, 3], [2]))
@pytest.mark.parametrize("name", mark_long(NAMES, ["valve_spring"]))
def test_all_platforms_export_the_functions_of_fmi(name: str, fmi: int, tmp_path: Path) -> None:
    path, found = build(name, tmp_path, fmi=fmi), {}
    with zipfile.ZipFile(path) as archive:
        for file in archive.namelist():
            if file.startswith("binaries/"):
                found[Path(file).parent.name] = file, libraries(archive.read(file))
    assert set(found) == {place.fmi2 if fmi == 2 else place.fmi3 for place in PLATFORMS.values()}
    for place in PLATFORMS.values():
        folder = place.fmi2 if fmi == 2 else place.fmi3
        file, (library,) = found[folder]
        assert file == f"binaries/{folder}/{name}{place.suffix}"
        assert platform(place.fmi3) == (library.format, library.processor)
        own = OF_THE_LINKER if place.suffix == ".dylib" else frozenset()
        assert library.exports == functions(fmi) | own, folder
    assert validate(path) == []
    assert path.stat().st_size < LIMIT or name in (LARGER if fmi == 2 else LARGER_IN_FMI_3)


@pytest.mark.parametrize(
    "line",
    ["getelementptr inbounds ptr, ptr %a, i64 1", "load <2 x ptr>, ptr %a", "alloca [3 x ptr], align 8"],
)
def test_kernels_with_pointers_in_arrays_have_no_code_where_pointers_are_shorter(line: str) -> None:
    with pytest.raises(NativeBuildError, match=r"^no code for wasm32-wasip2: a kernel keeps pointers in"):
        object_code(WEBASSEMBLY, [f"  %b = {line}"])


def test_a_component_that_needs_python_is_refused_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(TranslationError, match=r"^ehl_line_contact: .*Python.*ehl_contact"):
        build("ehl_line_contact", tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_run_with_it_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    done = called("run", "valve-train-ehl", "--native", "--out", str(tmp_path / "out"))
    assert done.returncode == 2
    assert "components.contact.component = ehl_line_contact" in said(done)
    assert not (tmp_path / "out").exists()


def test_of_a_traceback_the_error_and_its_first_explanation_are_told() -> None:
    text = (
        "Traceback (most recent call last):\n  raise error\n"
        "\x1b[1mnumba.core.errors.TypingError: Failed\x1b[0m\n\n\x1b[1mNo implementation of f\x1b[0m\n"
        "During: typing of g\n"
    )
    assert _summarise(text) == "numba.core.errors.TypingError: Failed No implementation of f"


@pytest.mark.long
def test_what_the_compiler_says_is_one_line_without_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its error and the first line of the explanation, not the last line of all."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.delenv("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING")
    with pytest.raises(TranslationError) as raised:
        translate("ehl_line_contact", {"nodes": 51})
    said = str(raised.value)
    assert said.startswith("native code of ehl_line_contact: ")
    assert "\x1b" not in said
    assert "\n" not in said
    assert "During:" not in said


@pytest.mark.long
def test_kernels_do_not_depend_on_what_was_compiled_before(tmp_path: Path) -> None:
    """With an empty cache and with the one that this fills."""
    environment = os.environ | {"TRIBOCOSIM_CACHE": str(tmp_path / "cache"), "XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, "-m", "models.native.translate", "flywheel", ""]
    cold, warm = (
        subprocess.run(command, env=environment, capture_output=True, check=True, text=True).stdout
        for _ in range(2)
    )
    assert "kernel_" in cold
    assert cold == warm
