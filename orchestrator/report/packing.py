"""Numbers for a page: float32, their bytes sorted by place, deflated, in base64."""

import base64
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.core.quantities import Vector

# Bits of the mantissa that are kept: relative roundings of 8e-6, and of 2e-3 for differences.
PRECISE, COARSE = 16, 8
MANTISSA = 23
# Parts of the range of a variable of which every row is kept.
DIVISIONS = 1 << 14
# Of deflate. The default, 6, takes twice the time and saves 3 %.
LEVEL = 4


def pack(values: Vector, bits: int = PRECISE) -> str:
    """The text of these values, rounded to so many bits of mantissa; `unpack` in series.js reads it."""
    single = np.ascontiguousarray(values, dtype=np.float32)
    drop = MANTISSA - bits
    whole = single.view(np.uint32)
    rounded = ((whole + np.uint32(1 << (drop - 1))) >> np.uint32(drop)) << np.uint32(drop)
    kept = np.where(np.isfinite(single) & np.isfinite(rounded.view(np.float32)), rounded, whole)
    return _deflate(kept.view(np.uint8).reshape(-1, 4))


def pack_exactly(values: Vector) -> str:
    """The text of these values as float64."""
    return _deflate(np.ascontiguousarray(values, dtype=np.float64).view(np.uint8).reshape(-1, 8))


def pack_detail(values: Vector) -> dict[str, Any]:
    """Finite values as multiples of a part of their range, by their second differences: of a smooth signal
    that is sampled closely, a third of what `pack` takes. `unpackDetail` in series.js reads it."""
    least = float(np.min(values))
    step = (float(np.max(values)) - least) / DIVISIONS or 1.0
    whole = np.rint((values - least) / step).astype(np.int32)
    second = np.diff(whole, n=2, prepend=np.zeros(2, np.int32)).astype(np.int32)
    return {"text": _deflate(second.view(np.uint8).reshape(-1, 4)), "least": least, "step": step}


def _deflate(rows: Any) -> str:
    return base64.b64encode(zlib.compress(rows.T.tobytes(), LEVEL)).decode("ascii")


def list_spans(rows: NDArray[np.bool_], size: int = 1) -> list[list[int]]:
    """Begin and end of the rows that are true, in stretches of `size` rows of which any is."""
    any_of = np.logical_or.reduceat(rows, np.arange(0, len(rows), size)) if len(rows) else rows
    edges = np.flatnonzero(np.diff(any_of, prepend=False, append=False))
    return [[int(begin), int(end)] for begin, end in edges.reshape(-1, 2)]


def bucket(values: Vector, size: int) -> tuple[Vector, Vector]:
    """Least and largest value of each `size` rows; NaN only where all are."""
    count = -(-len(values) // size)
    padded = np.pad(values, (0, count * size - len(values)), mode="edge").reshape(count, size)
    low = np.fmin.reduce(padded, axis=1)
    return low, np.fmax.reduce(padded, axis=1)
