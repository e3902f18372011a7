"""A program that is solved again and again with other numbers."""

from __future__ import annotations

from typing import Any, Mapping, Optional, Sequence

import numpy as np

from . import _arrays, _carom
from ._model import Model, Result
from ._settings import settings

SIDES = ("l", "u", "lb", "ub")


class Prepared:
    """A program that is solved again and again with other limits, bounds and costs.

    What is the same for all numbers is done once, and each solve begins with the last one's tree, cuts and
    integers; they are proved again and never trusted, so every solve has the status and, within the gap, the
    objective of one from nothing.

    The arrays are those of `Model`. `ranges` says which of `l`, `u`, `lb` and `ub` change, and how far: a
    dictionary from the name to (least, most), each an array of the same shape, or a number for all. Where both
    are equal, the number stays. Where a limit is infinite, it stays too. Rows with `l` equal to `u` and the same
    range for both are equations of each solve. Narrow ranges are solved faster than wide ones.

    `q` and `offset` may be others in each solve without a range. Costs that have just changed are solved without
    preparation, from the last integers.

    One thread at a time can solve it; several of them can solve at once.

    >>> import carom, numpy
    >>> prepared = carom.Prepared(q=[1, 3], A=[[1, 2]], l=4, ub=[3, 9], lb=0, integrality=[1, 1], ranges={"l": (0, 15)})
    >>> [prepared.solve(l=need).objective for need in (4, 5, 11)]
    [5.0, 6.0, 15.0]

    Raises what `Model` raises, and ValueError for ranges without the number that the arrays have.
    """

    def __init__(
        self, P: Any = None, q: Any = None, A: Any = None, l: Any = None, u: Any = None, lb: Any = None,
        ub: Any = None, integrality: Any = None, cones: Optional[Sequence[Any]] = None, *, offset: float = 0.0,
        names: Optional[Sequence[str]] = None, ranges: Optional[Mapping[str, Any]] = None,
    ) -> None:
        arrays = _arrays.program(P, q, A, l, u, lb, ub, integrality, cones, offset, names)
        self._given = (P, A, integrality, cones, names)
        self._now = {**{name: arrays[name].tobytes() for name in (*SIDES, "q")}, "offset": arrays["offset"]}
        self._sizes = {name: len(arrays[name]) for name in (*SIDES, "q")}
        checked = {name: None for name in SIDES}
        for name, range_of in (ranges or {}).items():
            if name not in SIDES:
                raise ValueError(f"`ranges` has no `{name}`; it is about `l`, `u`, `lb` and `ub`, and `q` needs none")
            checked[name] = tuple(side.tobytes() for side in self._range(name, range_of, arrays[name]))
        self._prepared = _carom.Prepared(_arrays.to_bytes(arrays), checked)

    @staticmethod
    def _range(name: str, given: Any, now: np.ndarray) -> "tuple[np.ndarray, np.ndarray]":
        if not isinstance(given, (tuple, list)) or len(given) != 2:
            raise TypeError(f"`ranges['{name}']` must be a pair (least, most)")
        word = f"ranges['{name}']"
        low, high = (_arrays.vector(word, side, len(now), 0.0).copy() for side in given)
        open_ends = np.isinf(now)
        low[open_ends], high[open_ends] = now[open_ends], now[open_ends]
        bad = ~(low <= now) | ~(now <= high) | (np.isinf(low) & ~open_ends) | (np.isinf(high) & ~open_ends)
        if bad.any():
            k = int(np.flatnonzero(bad)[0])
            raise ValueError(
                f"`{word}` is {low[k]} to {high[k]} at {k}; it must be finite and hold `{name}[{k}]`, which is {now[k]}"
            )
        return low, high

    def solve(
        self, *, l: Any = None, u: Any = None, lb: Any = None, ub: Any = None, q: Any = None,
        offset: Optional[float] = None, **options: Any,
    ) -> Result:
        """Solves the program with these numbers; those that are not given are the last ones.

        Each array has the shape that it was prepared with, or is a number for all entries. The options are those
        of `carom.solve`.

        Raises ValueError for a number that has no range or is outside of it, and RuntimeError if another thread
        solves this program at the same time.
        """
        now = self._now
        given: "dict[str, Any]" = {"l": l, "u": u, "lb": lb, "ub": ub, "q": q, "offset": offset}
        taken, passed = now, given
        if l is not None or u is not None or lb is not None or ub is not None or q is not None or offset is not None:
            passed = {name: value if value is None else self._bytes(name, value) for name, value in given.items()}
            taken = {name: now[name] if value is None else value for name, value in passed.items()}
        answer = self._prepared.solve(passed, settings(options, self._sizes["q"]))
        self._now = taken
        return Result(answer, lambda: self._model(taken))

    def _bytes(self, name: str, value: Any) -> Any:
        """A number or an array as the extension takes it; an array of the caller's may change later."""
        if name == "offset":
            return float(_arrays.finite(name, _arrays.vector(name, value, 1, 0.0))[0])
        size = self._sizes[name]
        # What loops do costs least.
        if type(value) is np.ndarray and value.dtype == np.float64 and value.shape == (size,) and name != "q":
            return value.tobytes()
        array = _arrays.vector(name, value, size, 0.0)
        return (_arrays.finite(name, array) if name == "q" else array).tobytes()

    def _model(self, numbers: "dict[str, Any]") -> Model:
        P, A, integrality, cones, names = self._given
        known = {name: value if name == "offset" else np.frombuffer(value) for name, value in numbers.items()}
        sides = {name: known[name] for name in (*SIDES, "q") if A is not None or name not in ("l", "u")}
        return Model(P=P, A=A, integrality=integrality, cones=cones, offset=known["offset"], names=names, **sides)
