"""Friction in the motion of a train and outside of it: what the drive gives is what is in the motion."""

import csv
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import xarray

from models.contact.hertz import elastic_compliance
from models.core.system import System
from orchestrator.assessment.friction.losses import list_losses, name_outside
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, list_parameters

from .commands import called


@pytest.mark.parametrize(
    ("scenario", "cut", "outside"),
    [
        ("roller-friction", "roller.rolling_friction", "rolling (cam_contact)"),
        ("roller-friction", "finger.tip_friction", "valve tip (pad)"),
        ("bucket-friction", "tappet.cam_friction", "cam contact (contact), tappet bore (spin)"),
        ("rocker-friction", "rocker.pivot_torque", "rolling (cam_contact), lever pivot (pivot)"),
        ("rocker-friction", "flywheel.load_torque[1]",
         "cam contact (cam_contact), rolling (cam_contact), lever pivot (pivot), valve tip (pad)"),
    ],
)  # fmt: skip
def test_friction_is_in_the_motion_where_all_that_it_brakes_take_it(scenario, cut, outside) -> None:
    """Not where one of two surfaces does, where only a side load hears of it, or where no torque goes on."""
    whole = build_system(load(scenario))
    kept = [(str(c.source), str(c.target)) for c in whole.connections if str(c.target) != cut]
    assert len(kept) == len(whole.connections) - 1
    assert name_outside(list_losses(System(whole.instances, kept))) == outside


# A direct train whose shaft feels the friction of the contact, with a guide.
RUBBING = """
extends = "valve-train"
stop_time = "60 ms"
macro_step = "20 us"
connections = [
    "contact.friction_force -> camshaft.friction_force",
    "valve_spring.velocity -> guide.velocity",
    "guide.friction_force -> valve_spring.guide_friction",
]
[components]
flywheel.participant = "in-process"
camshaft.participant = "in-process"
valve_spring.participant = "in-process"
contact.participant = "in-process"
guide = { component = "guide_friction", participant = "in-process" }
"""


@pytest.mark.parametrize(
    ("scenario", "joints", "cam", "outside"),
    [
        (RUBBING, ("guide",), ("contact", "camshaft"), "rolling (contact)"),
        pytest.param(
            'extends = "roller-friction"', ("pin", "pad", "guide", "roller"), ("cam_contact", "finger"), "",
            marks=pytest.mark.long,
        ),
    ],
    ids=["direct train", "roller train"],
)  # fmt: skip
def test_the_drive_gives_the_friction_in_the_motion_and_no_other(scenario, joints, cam, outside, tmp_path):
    """Besides, what dampers and stores take. Both sides of the friction add up to the sum that is printed."""
    (tmp_path / "train.toml").write_text(scenario)
    out = tmp_path / "out"
    changed = [part for name in ("reference.enabled=false", "energy.ledger=true") for part in ("--set", name)]
    done = called("run", str(tmp_path / "train.toml"), *changed, "--no-figures", "--out", str(out))
    assert done.returncode == 0, done.stderr
    summary = json.loads((out / "summary.json").read_text("utf-8"))
    parts, friction = summary["energy"]["components"], summary["friction"]
    with xarray.open_dataset(out / "result.nc", group="coupled", engine="h5netcdf") as result:
        columns = {str(name): result[name].values for name in result.variables}
    time = columns["time"]
    # Rows of 20 and 40 us; sticking takes elastic energy that it gives back.
    for name in joints:
        work = float(np.trapezoid(columns[f"{name}.power_loss"], time))
        assert work == pytest.approx(parts[name]["received"], rel=3e-4, abs=1e-5)
    drive = parts.pop("flywheel")["sourced"]
    besides = sum(part["received"] for name, part in parts.items() if name not in joints)
    # The trapezoidal rule of the friction from records.
    assert drive == pytest.approx(np.ptp(time) * friction["in_the_motion"] + besides, rel=1e-4)
    assert friction["left_out"] == outside
    assert f"friction {friction['in_the_motion'] + friction['outside']:.3g} W" in done.stdout
    rows = list(csv.DictReader((out / "summary.csv").read_text("utf-8-sig").splitlines()))
    for side, note in (("in_the_motion", "in the motion"), ("outside", "outside the motion")):
        own = [float(r["value"]) for r in rows if r["friction"] == note and r["unit"] == "W"]
        assert sum(own) == pytest.approx(friction[side], rel=1e-5)
    (said,) = (line for line in done.stdout.splitlines() if "mean torque with all friction" in line)
    total, rubbed, *shares, rest = map(float, re.findall(r"(-?[\d.e-]+) N m", said.partition("; ")[0]))
    turned = np.ptp(columns["flywheel.angle"])
    assert total == pytest.approx((drive + np.ptp(time) * friction["outside"]) / turned, rel=6e-3)
    assert (sum(shares), rubbed + rest) == pytest.approx((rubbed, total), rel=6e-3)
    (note,) = {
        row["friction"] for row in rows if "torque" in row["figure of merit"] and row["part"] == "flywheel"
    }
    assert note == (f"without the friction of {outside}" if outside else "with all friction")
    # What parts take they dissipate or store, but for a changing radius R of the cam, which gives the elastic
    # energy dE/dR = c W^2/(2 pi L R) at a constant deflection, with the compliance c of the bodies.
    contact, values = cam[0], list_parameters(load(out / "scenario.toml"))
    bodies = (values[f"{contact}.{name}_{k}"] for k in "12" for name in ("youngs_modulus", "poissons_ratio"))
    squared = (columns[f"{contact}.load"] / columns[f"{contact}.damping_margin"]) ** 2
    given = float(np.trapezoid(squared, np.log(columns[f"{cam[1]}.radius_of_curvature"])))
    given *= elastic_compliance(*bodies) / (2.0 * math.pi * values[f"{contact}.length"])
    assert sum(part["outside_bonds"] for part in parts.values()) == pytest.approx(given, abs=1e-5 * drive)


@pytest.mark.long
def test_the_friction_of_a_tappet_is_what_its_shaft_feels(tmp_path: Path) -> None:
    """Over a revolution the drive gives friction's work and what contacts, rod and spring lose besides."""
    out = tmp_path / "out"
    changed = ("--set", "reference.enabled=false", "--set", "stop_time=2 revolutions", "--native")
    done = called("run", "qin2000-train", *changed, "--no-figures", "--out", str(out))
    assert done.returncode == 0, done.stderr
    found = called("friction", str(out))
    assert found.returncode == 0, found.stderr
    (line,) = (line for line in found.stdout.splitlines() if "mean friction torque" in line)
    torque = float(line.split()[-1])
    with xarray.open_dataset(out / "result.nc", group="coupled", engine="h5netcdf") as result:
        last = result["time"].values > 0.06
        drive = float(result["tappet.cam_torque"].values[last].mean())
    assert 0.9 * drive < torque < drive
