"""The files of the trade for a designed cam, each read back and compared with the design."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rich.console import Console

from models.core.quantities import Vector
from models.valve_train.cams.table import TURN

from ...analyses import load
from ...analyses._cam_profile import build_profile, interpolate
from ...analyses._cam_source import find_settings
from ...analyses._evaluate import evaluate
from ...errors import MistakeError, Words
from ...reporter import Reporter
from .files import CAM, SCENARIO
from .train import DesignedTrain

# Those that grinders and designers take, and how the command `cam` reads them.
FILES = {"cam.s96": "lift_table", "cam.mm.csv": "lift_table", "cam.in.csv": "lift_table",
         "cam.contour.csv": "contour"}  # fmt: skip


def deliver(out: Path, train: DesignedTrain, unknowns: Vector) -> Iterator[Words]:
    """Write what the command `cam` writes of the designed scenario; durations and differences in words."""
    folder, analysis = out / CAM, load("cam")
    settings = find_settings(str(out / SCENARIO), train.cam)
    table = evaluate(analysis, settings, folder, True, Reporter(Console(quiet=True)))
    durations = (math.degrees(table[f"duration_{name}"].item()) for name in ("1mm", "050"))
    yield "duration {:.2f} deg of the crank at 1 mm, {:.2f} deg at 0.050 in; {}".format(
        *durations, table["shape"].item()
    )
    lift = interpolate(train.lobe.points(unknowns[: train.lobe.count]))
    values = analysis.complete(settings)
    nose, angles = build_profile(values).nose, np.radians(np.arange(360))
    for name, key in FILES.items():
        turn = nose - math.pi if name.endswith(".s96") else 0.0
        try:
            read = build_profile({**values, "lift_table": "", key: str(folder / name)})
        except MistakeError as error:
            yield f"{name}: {error}"
            continue
        apart = max(abs(read.lift(a).s - lift((a + turn) % TURN).s) for a in angles)
        yield f"{name} read back: within {1e6 * apart:.2g} µm of the design"
