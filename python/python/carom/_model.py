"""Programs from arrays and from files, and what comes of a solve."""

from __future__ import annotations

import gzip
import os
import warnings
from typing import Any, Callable, NamedTuple, Optional, Sequence, Union

import numpy as np

from . import _arrays, _carom
from ._settings import settings


class Duals(NamedTuple):
    """Derivatives of the optimal objective: what one more unit costs.

    Each is the change of the objective per unit by which the limits or bounds move up, 0 where they do not
    bind. Where the derivatives to both sides differ, it is a number between them.
    """

    rows: np.ndarray
    """Of each row of `A`: objective's unit per row's unit, shape (rows,)."""
    bounds: np.ndarray
    """Of each variable (reduced costs): objective's unit per variable's unit, shape (variables,)."""


class Explanation(NamedTuple):
    """Why a program has no point: parts that cannot hold together."""

    status: str
    """`irreducible` (without any one of them the rest has a point), `reducible` (a limit came before all were
    tried), `feasible` (there is nothing to explain) or `unknown` (a limit came first)."""
    rows: "list[int]"
    """Rows of `A`, by number."""
    cones: "list[int]"
    """Cones, by number."""
    bounds: "list[int]"
    """Variables whose bounds play a part, by number; known only if bounds alone can be followed to the end."""
    names: "list[str]"
    """All of these by name, which is what a program from a file has: `row3`, `cone0` and `x2` in arrays."""
    text: str
    """The same in words."""

    def __str__(self) -> str:
        return self.text


class Result:
    """What came of a solve. `print(result)` shows the most important part in a line."""

    __slots__ = ("_answer", "_program", "_x", "_duals")

    def __init__(self, answer: "_carom.Answer", program: "Callable[[], Model]") -> None:
        self._answer, self._program = answer, program
        self._x: Optional[np.ndarray] = None
        self._duals: Optional[Duals] = None

    @property
    def status(self) -> str:
        """Why the search ended: `optimal`, `infeasible`, `unbounded`, a limit (`time_limit`, `node_limit`,
        `memory_limit`), `interrupted` (Ctrl-C, or the callback), or `stalled` (for numerical reasons a part of
        the search could be neither refuted nor finished). `optimal` and `infeasible` are proved; whatever the
        status, `x` is the best point found and `bound` holds."""
        return self._answer.status

    @property
    def x(self) -> Optional[np.ndarray]:
        """The best point, shape (variables,), with whole integers; `None` if none was found. It was checked
        against the program by code that shares nothing with the search."""
        if self._x is None and self._answer.has_point:
            self._x = np.frombuffer(self._answer.x())
        return self._x

    @property
    def objective(self) -> Optional[float]:
        """The objective at `x`; `None` without a point."""
        return self._answer.objective

    @property
    def bound(self) -> float:
        """The proved bound: no point has a better objective. Infinite if nothing is proved."""
        return self._answer.bound

    @property
    def gap(self) -> float:
        """The distance from `objective` to `bound`, relative to the objective's magnitude; infinite without a
        point."""
        return self._answer.gap

    @property
    def seconds(self) -> float:
        """How long the solver took (s), without Python."""
        return self._answer.seconds

    @property
    def statistics(self) -> "dict[str, Any]":
        """Counts by name: nodes, iterations of all relaxations, relaxations, seconds, and others."""
        return self._answer.statistics()

    @property
    def violation(self) -> Optional[float]:
        """The largest amount by which `x` misses a row, a cone or a bound, in its unit; at most the
        tolerance `feasibility`. `None` without a point."""
        return self._answer.largest_residual if self._answer.has_point else None

    @property
    def refused(self) -> "list[str]":
        """After `stalled`: what the point violates that misses the program least, in words."""
        return self._answer.refused()

    @property
    def duals(self) -> Optional[Duals]:
        """Shadow prices and reduced costs of a program without integers; `None` if it has integers (see `fixed`),
        is not solved to its optimum, or has none that pass their check."""
        if self._duals is None:
            found = self._answer.duals()
            if found is not None:
                rows, bounds = (np.frombuffer(part) for part in found)
                self._duals = Duals(rows, bounds)
        return self._duals

    @property
    def start(self) -> Optional[str]:
        """What became of the start: `accepted`, `repaired` (some integers had to change) or `rejected`; `None`
        if there was none."""
        return self._answer.start()

    @property
    def proof(self) -> "Optional[dict[str, Any]]":
        """The report on the proof that was asked for: `is_complete`, `commands`, `bytes`, the `bound` that it
        claims, and `failure`, the reason if it could not be written. `None` if none was written."""
        return self._answer.proof()

    def fixed(self, **options: Any) -> "Result":
        """Solves the program again with its integers fixed at `x`: its `duals` are those of the best point.

        Raises ValueError without a point."""
        if self.x is None:
            raise ValueError(f"there is no point whose integers could be fixed (the status is {self.status})")
        return self._program()._relaxed(self.x).solve(**options)

    def explain(self, time_limit: Optional[float] = None) -> Explanation:
        """Why the program has no point; see `Model.explain`."""
        return self._program().explain(time_limit)

    def __repr__(self) -> str:
        objective = "no point" if self.objective is None else f"objective {self.objective:.10g}"
        return f"<carom.Result: {self.status}, {objective}, bound {self.bound:.10g}, {self.seconds:.3f} s>"


class Model:
    """A program: minimise `x'Px/2 + q'x + offset` with `l <= A x <= u`, `lb <= x <= ub`, cones and integers.

    Arrays are numpy arrays or what numpy makes arrays of; `P`, `A` and the `C` of cones may also be matrices of
    scipy.sparse. All may be left out, but for one that tells the number n of variables.

    P: (n, n), symmetric (both triangles); positive semidefinite, or with a convex form over binaries.
    q: (n,). offset: a number.
    A: (m, n); l and u: (m,), or a number for all; -inf and inf are no limit.
    lb and ub: (n,), or a number for all; without them variables have no bounds.
    integrality: (n,), 1 or True for integers; with bounds within 0 and 1 they are binaries.
    cones: a list of tuples (C, d, e, f), each for `||C x + d|| <= e'x + f` in the Euclidean norm, with C (k, n),
        d (k,) or None, e (n,) or None, f a number.
    names: n names of variables, for files and explanations; without them `x0`, `x1`, ...

    Raises TypeError for what is no array of numbers, and ValueError for wrong shapes, NaN, crossed limits and an
    objective that is not convex; the text names the argument and what to do.
    """

    def __init__(
        self, P: Any = None, q: Any = None, A: Any = None, l: Any = None, u: Any = None, lb: Any = None,
        ub: Any = None, integrality: Any = None, cones: Optional[Sequence[Any]] = None, *, offset: float = 0.0,
        names: Optional[Sequence[str]] = None,
    ) -> None:
        arrays = _arrays.program(P, q, A, l, u, lb, ub, integrality, cones, offset, names)
        self._set(_carom.Program.of(_arrays.to_bytes(arrays)))

    def _set(self, program: "_carom.Program") -> None:
        self._program = program
        self._sizes = program.sizes()

    @classmethod
    def _of(cls, program: "_carom.Program") -> "Model":
        model = cls.__new__(cls)
        model._set(program)
        return model

    @property
    def names(self) -> "list[str]":
        """The names of the variables, in the order of `x`."""
        return self._program.names()

    def solve(self, **options: Any) -> Result:
        """Solves the program, while other threads of Python run. The options are those of `carom.solve`."""
        answer = self._program.solve(settings(options, self._sizes[0]))
        return Result(answer, lambda: self)

    def relaxed(self) -> "Model":
        """The program with continuous variables only; its bounds stay. The `duals` of its result are those of
        the relaxation."""
        return self._relaxed(None)

    def _relaxed(self, at: Optional[np.ndarray]) -> "Model":
        return Model._of(self._program.relaxed(None if at is None else at.tobytes()))

    def explain(self, time_limit: Optional[float] = None) -> Explanation:
        """Why there is no point: rows, cones and bounds that cannot hold together, of which none can be left
        out. It takes several solves; `time_limit` (s) is for all of them, and Ctrl-C ends them too."""
        given = {} if time_limit is None else {"time_limit": time_limit}
        found = self._program.explain(settings(given, self._sizes[0]))
        return Explanation(**found)

    def write(self, path: "Union[str, os.PathLike[str]]", format: Optional[str] = None) -> None:
        """Writes the program to a file: MPS, LP, CBF or NL, as `format` or else the end of the name says; with
        `.gz` after it, compressed. CBF and NL keep no names, and NL has an order of variables of its own."""
        text = self._program.write(_format(path, format))
        data = text.encode()
        with open(path, "wb") as file:
            file.write(gzip.compress(data) if _is_gzip(path) else data)

    def __str__(self) -> str:
        return str(self._program)

    def __repr__(self) -> str:
        variables, integers, rows, cones = self._sizes
        return f"<carom.Model: {variables} variables ({integers} integral), {rows} rows, {cones} cones>"


def read(path: "Union[str, os.PathLike[str]]", format: Optional[str] = None) -> Model:
    """The program of an MPS, LP, CBF, QPLIB or NL file, also of one compressed by gzip (`.gz`).

    The end of the name tells the format (`.mps`, `.lp`, `.cbf`, `.qplib`, `.nl`), unless `format` does. What the file
    repeats or omits is a warning of Python (`UserWarning`). Files may maximise; the objective and the bound of
    the result are in the file's own sense.

    Raises OSError for a file that cannot be read, and ValueError, with line and column, for one that is damaged.
    """
    kind = _format(path, format)
    with open(path, "rb") as file:
        data = file.read()
    if data[:2] == b"\x1f\x8b":
        data = gzip.decompress(data)
    program, said = _carom.Program.read(data, kind)
    for line in said:
        warnings.warn(f"{os.fspath(path)}: {line}", stacklevel=2)
    return Model._of(program)


def _is_gzip(path: "Union[str, os.PathLike[str]]") -> bool:
    return os.fspath(path).endswith(".gz")


def _format(path: "Union[str, os.PathLike[str]]", given: Optional[str]) -> str:
    if given is not None:
        return given.lower()
    name = os.fspath(path)
    name = name[:-3] if _is_gzip(path) else name
    return os.path.splitext(name)[1][1:].lower()


def solve(
    P: Any = None, q: Any = None, A: Any = None, l: Any = None, u: Any = None, lb: Any = None, ub: Any = None,
    integrality: Any = None, cones: Optional[Sequence[Any]] = None, *, offset: float = 0.0,
    names: Optional[Sequence[str]] = None, **options: Any,
) -> Result:
    """Minimises `x'Px/2 + q'x + offset` with `l <= A x <= u`, `lb <= x <= ub`, cones and integers.

    The arrays are those of `Model`, where shapes are. Without bounds, variables are free. The options:

    start: (n,), a point to begin with, NaN where nothing is known. Only its integers are used, and never trusted.
    time_limit: s. node_limit: nodes of the tree. memory_limit: bytes of the tree. Limits keep the best point.
    gap: the relative gap at which to stop (1e-6). absolute_gap: the same in the objective's unit (1e-7).
    feasibility: by how much a row or a bound may be missed, in its unit (1e-6).
    threads: threads of the search (1). deterministic: whether the search is the same for any number of them.
    callback: called with an `Incumbent` for each new best point, on the thread that called. If it returns
        something true, the search ends, with the status `interrupted`; an exception ends it and is raised.
    proof: a path for the proof of the bound, or of infeasibility, which another program can check.
    verbose: whether to print a log.

    Ctrl-C ends the search, keeps the best point and gives the status `interrupted`.

    >>> import carom
    >>> result = carom.solve(q=[-5, -4, -3], A=[[2, 3, 1], [4, 1, 2]], u=[5, 11], lb=0, ub=10, integrality=[1, 1, 1])
    >>> result.status, result.objective, result.x.tolist()
    ('optimal', -15.0, [0.0, 0.0, 5.0])
    """
    return Model(P, q, A, l, u, lb, ub, integrality, cones, offset=offset, names=names).solve(**options)
