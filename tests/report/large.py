"""Results of many rows, made up."""

from pathlib import Path

import numpy as np

from models.core.quantities import Quantity
from orchestrator.store.result_file import ResultFile


def write_large(folder: Path, rows: int, variables: int) -> None:
    """Sines over 10 s; a single row of the first stands out."""
    times = np.linspace(0.0, 10.0, rows)
    values = np.column_stack([np.sin((50.0 + i) * times) for i in range(variables)])
    values[rows // 8, 0] = 7.0
    quantities = {f"part.value{i}": Quantity("m", "a length") for i in range(variables)}
    with ResultFile(folder / "result.nc", {"scenario": "large", "versions": "none"}) as made:
        made.write("coupled", times, quantities, values)
        made.finish(True, "")
