"""Sums of rows, inner products and inverses of small matrices: loops along rows, which become vector code.

Matrices are whole arrays, parts of them told by where they begin: of parts, compilers do not know that their
rows lie side by side.
"""

from typing import Any

from ..compile.kernel import kernel


@kernel
def add_rows(out: Any, shares: Any, rows: Any, first: int, column: int) -> None:
    """out += shares rows[first.., column..], by four rows, so that `out` is read a quarter as often."""
    end = column + out.shape[0]
    count = shares.shape[0]
    whole = count - count % 4
    for k in range(0, whole, 4):
        a, b, c, d = shares[k], shares[k + 1], shares[k + 2], shares[k + 3]
        i1, i2, i3, i4 = first + k, first + k + 1, first + k + 2, first + k + 3
        one, two, three, four = (
            rows[i1, column:end], rows[i2, column:end], rows[i3, column:end], rows[i4, column:end],
        )  # fmt: skip
        for i in range(out.shape[0]):
            out[i] += (a * one[i] + b * two[i]) + (c * three[i] + d * four[i])
    for k in range(whole, count):
        share, row = shares[k], rows[first + k, column:end]
        for i in range(out.shape[0]):
            out[i] += share * row[i]


@kernel
def product(a: Any, b: Any) -> float:
    """a b, in four sums that do not wait for each other."""
    count = a.shape[0]
    whole = count - count % 4
    one, two, three, four = 0.0, 0.0, 0.0, 0.0
    for i in range(0, whole, 4):
        one += a[i] * b[i]
        two += a[i + 1] * b[i + 1]
        three += a[i + 2] * b[i + 2]
        four += a[i + 3] * b[i + 3]
    for i in range(whole, count):
        one += a[i] * b[i]
    return (one + two) + (three + four)


@kernel
def invert(a: Any, n: int, order: Any) -> bool:
    """a[:n, :n] in place, by Gauss and Jordan with row pivots; False, and not finite, if it is singular."""
    regular = True
    for k in range(n):
        pivot, largest = k, abs(a[k, k])
        for i in range(k + 1, n):
            if abs(a[i, k]) > largest:
                pivot, largest = i, abs(a[i, k])
        order[k] = pivot
        regular = regular and largest > 0.0
        if pivot != k:
            for m in range(n):
                a[k, m], a[pivot, m] = a[pivot, m], a[k, m]
        own = a[k, :n]
        inverse = 1.0 / own[k]
        own[k] = 1.0
        for m in range(n):
            own[m] *= inverse
        for i in range(n):
            if i == k:
                continue
            other = a[i, :n]
            factor = other[k]
            other[k] = 0.0
            for m in range(n):
                other[m] -= factor * own[m]
    for k in range(n - 1, -1, -1):
        pivot = int(order[k])
        if pivot != k:
            for i in range(n):
                a[i, k], a[i, pivot] = a[i, pivot], a[i, k]
    return regular
