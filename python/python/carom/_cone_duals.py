"""Multipliers of second-order cones at an optimum.

At its optimum, a program has the multipliers of the program in which each cone is replaced by the row that touches
it there, because both have the same first-order conditions. Where a cone is at its tip, rows through the tip take
its place, which may hold too little; then nothing is known.
"""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from . import _arrays, _carom
from ._arrays import Sparse
from ._model import Model, Result

# A cone is at its boundary, or at its tip, within this part of its size.
NEAR = 1e-6

# The program of rows is only asked about points near the optimum: this far for variables below 1, in their unit.
ROOM = 1.0

# By how much the optima of both programs may differ, relative to the objective (1 if that is smaller).
SAME = 1e-5


def cone_duals(arrays: "dict[str, Any]", result: Result) -> "Optional[tuple[np.ndarray, np.ndarray]]":
    """Shadow prices of the rows, and multipliers of the cones in the dual cones (one number an entry, the larger
    side first), of a program without integers; `None` if they are not known."""
    x, sizes, G, h = result.x, arrays["sizes"], arrays["G"], arrays["h"]
    dense = [row_of(G, k, len(x)) for k in range(len(h))]
    values = h + np.array([row @ x for row in dense])
    rows, limits, places = [], [], []
    first = 0
    for size in sizes:
        entries = np.arange(first, first + size)
        for direction in touching(values[entries]):
            # `s_0 >= direction' s_1`
            weights = np.concatenate(([1.0], -direction))
            rows.append(sum(weight * dense[k] for weight, k in zip(weights, entries)))
            limits.append(-float(weights @ h[entries]))
            places.append((entries, weights))
        first += size
    near = {
        **arrays, "G": None, "h": np.zeros(0), "sizes": np.zeros(0, dtype=np.int64), "names": None,
        "A": joined(arrays["A"], rows, len(x)),
        "l": np.concatenate((arrays["l"], limits)), "u": np.concatenate((arrays["u"], np.full(len(rows), np.inf))),
        "lb": np.maximum(arrays["lb"], x - ROOM * np.maximum(1.0, np.abs(x))),
        "ub": np.minimum(arrays["ub"], x + ROOM * np.maximum(1.0, np.abs(x))),
    }
    touched = Model._of(_carom.Program.of(_arrays.to_bytes(near))).solve()
    if touched.duals is None or touched.objective is None or result.objective is None:
        return None
    if abs(touched.objective - result.objective) > SAME * max(1.0, abs(result.objective)):
        return None
    count = len(arrays["l"])
    multipliers = np.zeros(len(h))
    for (entries, weights), price in zip(places, touched.duals.rows[count:]):
        multipliers[entries] += price * weights
    return touched.duals.rows[:count], multipliers


def touching(values: np.ndarray) -> "list[np.ndarray]":
    """The directions of the rows that touch a cone at a point; none inside of it."""
    length = float(np.linalg.norm(values[1:]))
    size = max(1.0, abs(float(values[0])))
    if values[0] - length > NEAR * size:
        return []
    if length > NEAR * size:
        return [values[1:] / length]
    axes = np.eye(len(values) - 1)
    return [sign * axis for axis in axes for sign in (1.0, -1.0)] or [np.zeros(0)]


def row_of(matrix: Sparse, row: int, size: int) -> np.ndarray:
    """A row of a sparse matrix."""
    dense = np.zeros(size)
    place = slice(matrix.starts[row], matrix.starts[row + 1])
    np.add.at(dense, matrix.columns[place], matrix.values[place])
    return dense


def joined(matrix: Optional[Sparse], rows: "list[np.ndarray]", size: int) -> Sparse:
    """A matrix with further rows."""
    below = _arrays.matrix("rows", np.array(rows).reshape(len(rows), size), size)
    if matrix is None:
        return below
    return Sparse(
        np.concatenate((matrix.starts, below.starts[1:] + matrix.starts[-1])),
        np.concatenate((matrix.columns, below.columns)),
        np.concatenate((matrix.values, below.values)),
    )
