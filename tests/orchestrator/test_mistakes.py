"""A mistake in a command: one message, status 2, before anything is printed or written."""

import shlex

import pytest

from .commands import called, said

SHIPPED = "orchestrator/scenario/shipped"
FOLDER = "none: there is no such folder; give the output folder"
# By command; OUT is a folder that is not there.
MISTAKES = {
    "run": "run [OPTIONS] {scenario}",
    "run valve-train --ovr": "tribocosim: run: no option --ovr; did you mean --out or --overwrite?",
    "run valve-train --out": "run: option '--out' requires an argument; `tribocosim run --help` lists",
    "run a --overwrite=3": "run: option '--overwrite' does not take a value",
    "run a b": "run: got unexpected extra arguments (b)",
    "fmu build --fmi": "fmu build: option '--fmi' requires an argument; `tribocosim fmu build --help` lists",
    "fmu buld": "fmu: no such command 'buld'",
    "fmu build --fmi x": "fmu build: --fmi",
    "speeds a --workers 0": "speeds: --workers",
    "calibrate leak-down none.csv": "--parameters: names none; e.g. --parameters weight.mass",
    "run none.toml": "? tribocosim scenarios lists those shipped",
    "run .": "is a folder; give the path of a .toml file, or a shipped scenario: tribocosim scenarios lists",
    "run valve-train --master jacob --out OUT": "did you mean jacobi?",
    "run valve-train --out pyproject.toml": "is a file",
    "run valve-train --out /proc/none": "/proc/none: no folder can be made in /proc; choose another --out",
    "run valve-train --set components.camshaft.parameters.lift=9 --out OUT": "did you mean 9 mm?",
    "speeds valve-train --count 2 --out pyproject.toml/x": "pyproject.toml: is a file",
    "resume none": FOLDER,
    "report none": FOLDER,
    "diagnose none": FOLDER,
    "friction none": FOLDER,
    "compare none docs": FOLDER,
    "resume docs": "docs: holds no run",
    "report docs": "docs: has no result.nc",
    "compare docs docs": "docs: holds no finished sweep",
    "calibrate valve-train none.csv --parameters contact.viscosity --out OUT": "none.csv: cannot be read",
    "sensitivities valve-train --speed 2000 --out OUT": "--speed 2000: write the unit",
    "tolerances valve-train none.toml --out OUT": "none.toml: cannot be read",
    "speeds quarter-car --out OUT": "no flywheel prescribes the speed",
    "speeds slider-crank --out OUT": "has no cam",
    "speeds valve-tran --out OUT": "did you mean valve-train",
    "speeds my-cam --from '2000 rpm' --to '1000 rpm' --out OUT": "--from '2000 rpm': must be less than --to",
    "speeds my-cam --from '2 mm' --out OUT": "--from = '2 mm'",
    "speeds my-cam --from 500 --out OUT": "--from 500: write the unit, e.g. 500 rpm, or 500 rad/s",
    "speeds valve-train --set components.valve_spring.parameters.spring_rate=45 --out OUT": "mean 45 N/mm?",
    "speeds valve-train --set 'components.camshaft.parameters.base_radius=12 mm' --out OUT": "undercut",
    "wear slider-crank --until '3 mm' --out OUT": "no contact slides on a cam",
    "wear pushrod-engine --until '3 mm' --out OUT": "choose --contact",
    "wear valve-train --until '3 mm' --out OUT": "or less",
    "design valve-trian --out OUT": "did you mean valve-train",
    "cam cycloidl --out OUT": "did you mean cycloidal?",
    "cam my-cm --out OUT": "did you mean my-cam?",
    "cam no-such-thing --out OUT": "or a file: a lift table .csv",
    "cam quarter-car --out OUT": "no component has a cam",
    "cam engine-16v --out OUT": "choose one with --component",
    "cam engine-16v --component tappet_intake_2 --out OUT": "did you mean tappet_intake_2",
    "cam cycloidal --component camshaft --out OUT": "is no scenario",
    "cam absent.toml --out OUT": "no such scenario file",
    "cam absent.csv --out OUT": "absent.csv: no such file; give a path, a law",
    f"cam {SHIPPED}/my-cams.csv --out OUT": f"no such file; did you mean {SHIPPED}/my-cam.csv",
    # Of numbers that are plausible only in another unit than SI.
    "cam cycloidal --base-radius 24 --out OUT": "Write the unit",
    "cam cycloidal --speed 3000 --out OUT": "Write the unit",
    # 10 mm at the valve are 8 mm at the rod's end of the rocker.
    **{
        f"{name} pushrod-train --set 'components.valve_spring.parameters.lash=10 mm' --out OUT": (
            "its lash takes 8 mm of the lift of tappet, which is 7.35 mm; lower the lash"
        )
        for name in ("run", "speeds", "design", "wear", "sensitivities", "analyse", "masters")
    },
    "ssp import README.md --out OUT": "README.md: is no package; give an .ssp file",
    "components camshft": "did you mean camshaft",
    "fmu validate none.fmu": "no such file",
    "fmu validate docs": "docs: is a folder; give its files: docs/*.fmu",
    "fmu info none.fmu": "no such file",
    "fmu info pyproject.toml": "not an FMU",
    "fmu compare none.fmu": "no such file",
    "fmu compare docs": "docs: has no .fmu files",
    "fmu compare pyproject.toml": "not a zip archive",
    "fmu compare docs --tolerance 0": "must be > 0",
    "fmu build camsaft": "did you mean camshaft?",
    "fmu build --structure coil_masses=3": "name the one component",
    "fmu build valve_spring --structure coil_masses": "must be NAME=NUMBER",
    "fmu build valve_spring --structure coil_masses=-3": "coil_masses = -3: must be from 1 to",
    "fmu build valve_spring --structure coils=3": "did you mean coil_masses?",
    "fmu build ehl_line_contact --structure nodes=-1": "nodes = -1: must be odd",
    "fmu build camshaft --platform x86_64-linux": "for Linux and Windows alike",
    "fmu build flywheel --fmi 3": "add --native",
    "fmu build flywheel --native --fmi 1": "--fmi 1: must be 2 or 3",
}


@pytest.mark.parametrize("line", MISTAKES)
def test_a_mistake_is_one_message_before_anything_is_written(line, tmp_path):
    out = tmp_path / "out"
    done = called(*shlex.split(line.replace("OUT", str(out))))
    assert (done.returncode, done.stdout) == (2, "")
    assert MISTAKES[line] in said(done)
    assert not out.exists()
