"""The settings of a solve, checked, as the extension takes them."""

from __future__ import annotations

import os
from typing import Any, Callable, Optional

import numpy as np

from ._arrays import numbers

DEFAULTS: "dict[str, Any]" = {
    "time_limit": None, "node_limit": None, "memory_limit": None, "gap": None, "absolute_gap": None,
    "feasibility": None, "threads": 1, "deterministic": False, "proof": None, "verbose": False,
    "callback": None, "start": None,
}


class Incumbent:
    """A new best point, while the search goes on; what a callback gets."""

    __slots__ = ("x", "objective", "bound", "gap", "nodes", "seconds")

    def __init__(self, x: bytearray, objective: float, bound: float, gap: float, nodes: int, seconds: float) -> None:
        self.x = np.frombuffer(x)
        self.objective, self.bound, self.gap = objective, bound, gap
        self.nodes, self.seconds = nodes, seconds

    def __repr__(self) -> str:
        return f"Incumbent(objective={self.objective!r}, bound={self.bound!r}, seconds={self.seconds:.3f})"


def whole(name: str, value: Any, least: int) -> int:
    """A whole number."""
    try:
        number = int(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise TypeError(f"`{name}` must be a whole number, not {value!r}") from error
    if number != value or isinstance(value, str) or number < least:
        raise ValueError(f"`{name}` is {value!r} and must be a whole number, at least {least}")
    return number


def real(name: str, value: Any) -> float:
    """A number of at least 0."""
    if isinstance(value, str):
        raise TypeError(f"`{name}` must be a number, not {value!r}")
    try:
        number = float(value)
    except (TypeError, ValueError) as error:
        raise TypeError(f"`{name}` must be a number, not {value!r}") from error
    if not number >= 0.0:
        raise ValueError(f"`{name}` is {number} and must be at least 0")
    return number


def wrapped(callback: Callable[[Incumbent], Any]) -> Callable[..., Any]:
    """The callback as the extension calls it."""
    return lambda *found: callback(Incumbent(*found))


def start_of(value: Any, size: int) -> Optional[bytes]:
    """A start with a number or NaN for each variable."""
    array = numbers("start", value)
    if array.shape != (size,):
        raise ValueError(f"`start` has the shape {array.shape} and must have the shape ({size},), with NaN for what is not known")
    return np.ascontiguousarray(array).tobytes()


def settings(given: "dict[str, Any]", size: int) -> "dict[str, Any]":
    """The settings of a solve."""
    if not given:
        return DEFAULTS
    unknown = [name for name in given if name not in DEFAULTS]
    if unknown:
        raise TypeError(f"there is no option `{unknown[0]}`; there are {', '.join(DEFAULTS)}")
    all_of = {**DEFAULTS, **given}
    for name in ("time_limit", "gap", "absolute_gap", "feasibility"):
        if all_of[name] is not None:
            all_of[name] = real(name, all_of[name])
    for name in ("node_limit", "memory_limit"):
        if all_of[name] is not None:
            all_of[name] = whole(name, all_of[name], 0)
    all_of["threads"] = whole("threads", all_of["threads"], 1)
    for name in ("deterministic", "verbose"):
        all_of[name] = bool(all_of[name])
    if all_of["proof"] is not None:
        all_of["proof"] = os.fspath(all_of["proof"])
    if all_of["callback"] is not None:
        if not callable(all_of["callback"]):
            raise TypeError(f"`callback` must be a function of an Incumbent, not {type(all_of['callback']).__name__}")
        all_of["callback"] = wrapped(all_of["callback"])
    if all_of["start"] is not None:
        all_of["start"] = start_of(all_of["start"], size)
    return all_of
