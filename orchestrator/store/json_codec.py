"""Plain data as JSON and back, to the last bit, for checkpoints.

Plain data are None, booleans, numbers, strings, bytes, numpy arrays of numbers, and lists and dicts (with
strings as keys) of these. Unlike a pickle, reading it never runs code.
"""

import base64
import json
import math
import re
from typing import Any

import numpy as np

Plain = Any

ARRAY, BYTES = "$array", "$bytes"
_KINDS = re.compile(r"[<|>][biuf]\d{1,2}")


def to_text(data: Plain) -> str:
    """The data as JSON; TypeError for what is not plain."""
    return json.dumps(_to_plain(data), separators=(",", ":"))


def from_text(text: str) -> Plain:
    """The data of a text by `to_text`, tuples as lists. Raises ValueError for another text."""
    try:
        return _read(json.loads(text))
    except (KeyError, TypeError, RecursionError) as error:
        raise ValueError(f"not plain data: {error!r}") from None


def _to_plain(data: Plain) -> Any:
    if isinstance(data, np.ndarray):
        if not _KINDS.fullmatch(data.dtype.str):
            raise TypeError(f"an array of {data.dtype} is not plain data")
        # The order in memory too: products of matrices depend on it in the last bit.
        order: Any = "F" if data.flags.fnc else "C"
        return {ARRAY: [data.dtype.str, list(data.shape), order, _base64(data.tobytes(order))]}
    if isinstance(data, np.generic):
        return _to_plain(data.item())
    if isinstance(data, bytes):
        return {BYTES: _base64(data)}
    if isinstance(data, dict):
        if not all(isinstance(key, str) and not key.startswith("$") for key in data):
            raise TypeError(f"keys of plain data are texts that do not begin with $: {list(data)}")
        return {key: _to_plain(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_to_plain(value) for value in data]
    if data is None or isinstance(data, (bool, int, float, str)):
        return data
    raise TypeError(f"{type(data).__name__} is not plain data")


def _read(data: Any) -> Plain:
    if isinstance(data, list):
        return [_read(value) for value in data]
    if not isinstance(data, dict):
        return data
    if BYTES in data:
        return base64.b64decode(data[BYTES], validate=True)
    if ARRAY in data:
        kind, shape, order, content = data[ARRAY]
        if not _KINDS.fullmatch(kind) or min(shape, default=0) < 0 or order not in ("C", "F"):
            raise ValueError(f"an array of {kind!r}, shape {shape} and order {order!r} is not plain data")
        values = np.frombuffer(base64.b64decode(content, validate=True), np.dtype(kind))
        if len(values) != math.prod(shape):
            raise ValueError(f"an array of shape {shape} has {len(values)} values")
        return values.reshape(shape, order=order).copy(order)
    return {key: _read(value) for key, value in data.items()}


def _base64(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")
