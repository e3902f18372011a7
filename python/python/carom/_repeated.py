"""A program that comes again with other limits and bounds, as problems of CVXPY with parameters do.

It is prepared for the numbers that were seen, and as far beyond them on both sides. Numbers farther away have it
prepared again, so that ranges grow with what is asked.
"""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from . import _arrays, _carom

SIDES = ("l", "u", "lb", "ub")
MATRICES = ("P", "A", "G")


class Repeated:
    """The program of the solves so far."""

    def __init__(self, arrays: "dict[str, Any]") -> None:
        self._arrays = arrays
        self._low = {name: arrays[name] for name in SIDES}
        self._high = dict(self._low)
        self._prepared: Optional[_carom.Prepared] = None
        self._costs = arrays["q"]

    def takes(self, arrays: "dict[str, Any]") -> bool:
        """Whether it differs in limits, bounds and costs alone, has integers, and has had other limits or bounds."""
        known = self._arrays
        names = ("h", "sizes", "integrality")
        if not arrays["integrality"].any() or not all(np.array_equal(known[name], arrays[name]) for name in names):
            return False
        for name in MATRICES:
            one, other = known[name], arrays[name]
            if (one is None) != (other is None):
                return False
            if one is not None and not all(np.array_equal(*pair) for pair in zip(one, other)):
                return False
        if any(not np.array_equal(np.isinf(known[name]), np.isinf(arrays[name])) for name in SIDES):
            return False
        if not np.array_equal(known["l"] == known["u"], arrays["l"] == arrays["u"]):
            return False
        return self._prepared is not None or any(not np.array_equal(known[name], arrays[name]) for name in SIDES)

    def solve(self, arrays: "dict[str, Any]", settings: "dict[str, Any]") -> "_carom.Answer":
        """Solves it with these numbers."""
        if self._prepared is None or not self._holds(arrays):
            self._prepare(arrays)
        numbers: "dict[str, Any]" = {name: arrays[name].tobytes() for name in SIDES}
        same = np.array_equal(self._costs, arrays["q"])
        numbers.update(q=None if same else arrays["q"].tobytes(), offset=None)
        self._costs = arrays["q"]
        return self._prepared.solve(numbers, settings)

    def _holds(self, arrays: "dict[str, Any]") -> bool:
        return all(
            ((self._low[name] <= arrays[name]) & (arrays[name] <= self._high[name])).all() for name in SIDES
        )

    def _prepare(self, arrays: "dict[str, Any]") -> None:
        for name in SIDES:
            low, high = np.minimum(self._low[name], arrays[name]), np.maximum(self._high[name], arrays[name])
            # Not of infinite limits, which are the same.
            room = np.subtract(high, low, out=np.zeros_like(low), where=low != high)
            self._low[name], self._high[name] = low - room, high + room
        ranges = {name: (self._low[name].tobytes(), self._high[name].tobytes()) for name in SIDES}
        self._prepared = _carom.Prepared(_arrays.to_bytes(arrays), ranges)
        self._costs = arrays["q"]
