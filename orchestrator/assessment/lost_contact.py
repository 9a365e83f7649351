"""Speeds at which a train loses contact, in the table of a sweep."""

import numpy as np
import xarray
from numpy.typing import NDArray


def list_shares(table: xarray.Dataset, number: str = "lost") -> list[str]:
    """The names of this share of the cycle, one of each contact."""
    return [name for name in map(str, table.data_vars) if name.endswith(f".{number}")]


def find_lost(table: xarray.Dataset, number: str = "lost") -> NDArray[np.bool_]:
    """By speed, whether any contact has this share."""
    shares = [table[name].values for name in list_shares(table, number)]
    return np.any(np.reshape(shares, (len(shares), table.sizes["speed"])) > 0.0, axis=0)
