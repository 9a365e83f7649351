"""Small dense systems and sums of rows: loops along rows, which compilers turn into vector code."""

from __future__ import annotations

from typing import Any

from ...kernel import kernel


@kernel
def add_rows(out: Any, shares: Any, rows: Any) -> None:
    """out += shares rows, four rows at a time, so that `out` is read a quarter as often."""
    count = shares.shape[0]
    whole = count - count % 4
    for k in range(0, whole, 4):
        a, b, c, d = shares[k], shares[k + 1], shares[k + 2], shares[k + 3]
        first, second, third, fourth = rows[k], rows[k + 1], rows[k + 2], rows[k + 3]
        for i in range(out.shape[0]):
            out[i] += (a * first[i] + b * second[i]) + (c * third[i] + d * fourth[i])
    for k in range(whole, count):
        share, row = shares[k], rows[k]
        for i in range(out.shape[0]):
            out[i] += share * row[i]


@kernel
def products(rows: Any, x: Any, out: Any) -> None:
    """out[k] = rows[k] x, four rows at a time, whose sums do not wait for each other."""
    count = out.shape[0]
    whole = count - count % 4
    for k in range(0, whole, 4):
        first, second, third, fourth = rows[k], rows[k + 1], rows[k + 2], rows[k + 3]
        a, b, c, d = 0.0, 0.0, 0.0, 0.0
        for i in range(x.shape[0]):
            a += first[i] * x[i]
            b += second[i] * x[i]
            c += third[i] * x[i]
            d += fourth[i] * x[i]
        out[k], out[k + 1], out[k + 2], out[k + 3] = a, b, c, d
    for k in range(whole, count):
        row, total = rows[k], 0.0
        for i in range(x.shape[0]):
            total += row[i] * x[i]
        out[k] = total


@kernel
def lu(a: Any, pivot: Any, size: int) -> None:
    """LU factors of a[:size, :size] in place, rows exchanged for the largest pivot."""
    for k in range(size):
        best, largest = k, abs(a[k, k])
        for i in range(k + 1, size):
            if abs(a[i, k]) > largest:
                best, largest = i, abs(a[i, k])
        pivot[k] = best
        if best != k:
            for j in range(size):
                a[k, j], a[best, j] = a[best, j], a[k, j]
        inverse = 1.0 / a[k, k]
        for i in range(k + 1, size):
            factor = a[i, k] * inverse
            a[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, size):
                    a[i, j] -= factor * a[k, j]


@kernel
def solve_transposed(a: Any, pivot: Any, x: Any) -> None:
    """x becomes the solution of a^T y = x, from the factors that `lu` made of a: along rows of them."""
    size = x.shape[0]
    for k in range(size):
        share = x[k] / a[k, k]
        x[k] = share
        for i in range(k + 1, size):
            x[i] -= share * a[k, i]
    for k in range(size - 1, 0, -1):
        share = x[k]
        for i in range(k):
            x[i] -= share * a[k, i]
    for k in range(size - 1, -1, -1):
        best = int(pivot[k])
        if best != k:
            x[k], x[best] = x[best], x[k]
