"""carom as a solver of CVXPY: `problem.solve(solver=carom.CVXPY())`.

Linear and convex quadratic objectives, second-order cones, booleans, integers and bounds of variables. Whatever
CVXPY brings into these cones comes with it; semidefinite and exponential cones are refused by CVXPY's own check.
"""

from __future__ import annotations

from typing import Any, Optional

import cvxpy.settings as s
import numpy as np
from cvxpy.constraints import SOC
from cvxpy.error import SolverError
from cvxpy.reductions.solution import Solution, failure_solution
from cvxpy.reductions.solvers import utilities
from cvxpy.reductions.solvers.conic_solvers.conic_solver import ConicSolver
from scipy import sparse

from . import _arrays, _carom
from ._cone_duals import cone_duals
from ._model import Model, Result
from ._repeated import Repeated
from ._settings import settings

STATUSES = {"optimal": s.OPTIMAL, "infeasible": s.INFEASIBLE, "unbounded": s.UNBOUNDED, "stalled": s.OPTIMAL_INACCURATE}


class CVXPY(ConicSolver):
    """carom for `cvxpy.Problem.solve`.

    Options are those of `carom.solve`, by name, here for all solves or in `solve` for one:

        problem.solve(solver=carom.CVXPY(threads=2), time_limit=60, gap=1e-4, proof="plan.proof")

    With `warm_start` (CVXPY's default) the search begins with the integers that the variables have, from a solve
    before or from `variable.value = ...`. A problem with integers whose parameters change limits, bounds and costs
    alone is prepared when it comes again, as by `carom.Prepared`, for the numbers seen and as far beyond them. At a limit, and after Ctrl-C, the variables have the best point, with
    the status `user_limit`; `SolverError` is raised if there is none.

    `problem.solver_stats.extra_stats` is a dictionary: `status`, `bound` and `gap` as CVXPY gave the objective to
    the solver, which is minimised (for `Maximize`, the bound is the negative of one), `violation`, `start`,
    `proof` (the report on the proof) and `statistics`. Constraints have dual values if the problem has no integers.
    """

    MIP_CAPABLE = True
    BOUNDED_VARIABLES = True
    SUPPORTED_CONSTRAINTS = ConicSolver.SUPPORTED_CONSTRAINTS + [SOC]
    MI_SUPPORTED_CONSTRAINTS = SUPPORTED_CONSTRAINTS

    def __init__(self, **options: Any) -> None:
        self._options = options

    def name(self) -> str:
        """The name in messages of CVXPY."""
        return "CAROM"

    def import_solver(self) -> None:
        """Nothing more than this module is needed."""

    def supports_quad_obj(self) -> bool:
        """Quadratic objectives are not made into cones."""
        return True

    def cite(self, data: Any) -> str:
        """There is no publication to cite."""
        return ""

    def apply(self, problem: Any) -> "tuple[dict[str, Any], dict[str, Any]]":
        """The matrices of a problem, and what is needed to read the answer."""
        data, inverse = super().apply(problem)
        data[s.BOOL_IDX] = [int(index[0]) for index in problem.x.boolean_idx]
        data[s.INT_IDX] = [int(index[0]) for index in problem.x.integer_idx]
        data["init_value"] = utilities.stack_vals(problem.variables, np.nan)
        return data, inverse

    def solve_via_data(
        self, data: "dict[str, Any]", warm_start: bool, verbose: bool, solver_opts: "dict[str, Any]",
        solver_cache: Optional[dict] = None,
    ) -> "dict[str, Any]":
        """Solves `min x'Px/2 + c'x, Ax + s = b, s in K`."""
        options = {**self._options, **solver_opts}
        options.pop("use_quad_obj", None)
        options.setdefault("verbose", verbose)
        arrays = arrays_of(data)
        if (arrays["lb"] > arrays["ub"]).any():
            return {"result": None, "duals": None}
        start = data["init_value"]
        if warm_start and arrays["integrality"].any() and np.isfinite(start).any():
            options.setdefault("start", start)
        result = solved(arrays, options, self.name(), solver_cache if warm_start else None)
        if result.x is None and result.status not in ("infeasible", "unbounded"):
            raise SolverError(f"carom found no point before it stopped ({result.status}); the bound is {result.bound}")
        return {"result": result, "duals": duals_of(arrays, result)}

    def invert(self, solution: "dict[str, Any]", inverse_data: Any) -> Solution:
        """The answer in the variables and constraints of the problem."""
        result = solution["result"]
        if result is None:
            return failure_solution(s.INFEASIBLE)
        attributes = {s.SOLVE_TIME: result.seconds, s.NUM_ITERS: result.statistics["iterations"]}
        attributes[s.EXTRA_STATS] = {
            "status": result.status, "bound": result.bound + inverse_data[s.OFFSET], "gap": result.gap,
            "violation": result.violation, "start": result.start, "proof": result.proof,
            "statistics": result.statistics,
        }
        status = STATUSES.get(result.status, s.USER_LIMIT)
        if status not in s.SOLUTION_PRESENT:
            return failure_solution(status, attributes)
        duals = {}
        if solution["duals"] is not None:
            constraints = inverse_data[self.EQ_CONSTR] + inverse_data[self.NEQ_CONSTR]
            size = len(solution["duals"])
            known = [constraint for constraint in constraints if not isinstance(constraint, SOC)]
            # Without those of cones, the first ones are those of rows.
            is_whole = size == sum(sum(arg.size for arg in constraint.args) for constraint in constraints)
            duals = utilities.get_dual_values(
                solution["duals"], utilities.extract_dual_value, constraints if is_whole else known
            )
        values = {inverse_data[self.VAR_ID]: result.x}
        return Solution(status, result.objective + inverse_data[s.OFFSET], values, duals, attributes)


def arrays_of(data: "dict[str, Any]") -> "dict[str, Any]":
    """The arrays of a program, as `Model` makes them."""
    dims, b = data[ConicSolver.DIMS], data[s.B]
    A = sparse.csr_array(data[s.A])
    size, rows = A.shape[1], dims.zero + dims.nonneg
    lower, upper = data[s.LOWER_BOUNDS], data[s.UPPER_BOUNDS]
    arrays = _arrays.program(
        None, data[s.C], A[:rows], np.concatenate((b[: dims.zero], np.full(dims.nonneg, -np.inf))), b[:rows],
        None, None, None, None, 0.0, None,
    )
    if data.get(s.P) is not None:
        P = sparse.csr_array(data[s.P])
        arrays["P"] = _arrays.matrix("P", (P + P.T) / 2, size)
    integers, booleans = data[s.INT_IDX], data[s.BOOL_IDX]
    # They may cross, where the problem is infeasible.
    arrays["lb"] = arrays["lb"] if lower is None else np.array(lower, dtype=np.float64)
    arrays["ub"] = arrays["ub"] if upper is None else np.array(upper, dtype=np.float64)
    arrays["lb"][booleans] = np.maximum(arrays["lb"][booleans], 0.0)
    arrays["ub"][booleans] = np.minimum(arrays["ub"][booleans], 1.0)
    arrays["integrality"][integers + booleans] = 1
    if len(dims.soc):
        arrays["G"] = _arrays.matrix("A", -A[rows:], size)
        arrays["h"] = _arrays.finite("b", np.ascontiguousarray(b[rows:], dtype=np.float64))
        arrays["sizes"] = np.array(dims.soc, dtype=np.int64)
    return arrays


def solved(arrays: "dict[str, Any]", options: "dict[str, Any]", name: str, cache: Optional[dict]) -> Result:
    """Solves a program; one that comes again with other numbers is prepared."""

    def model() -> Model:
        return Model._of(_carom.Program.of(_arrays.to_bytes(arrays)))

    known = None if cache is None else cache.get(name)
    if known is not None and known.takes(arrays):
        return Result(known.solve(arrays, settings(options, len(arrays["q"]))), model)
    if cache is not None:
        cache[name] = Repeated(arrays)
    return model().solve(**options)


def duals_of(arrays: "dict[str, Any]", result: Result) -> Optional[np.ndarray]:
    """CVXPY's dual values of rows and cones, or of rows alone if those of cones are not known."""
    if result.status != "optimal" or arrays["integrality"].any():
        return None
    if arrays["G"] is not None:
        found = cone_duals(arrays, result)
        if found is not None:
            return np.concatenate((-found[0], found[1]))
    # A row's multiplier is what its limit costs per unit down.
    return None if result.duals is None else -result.duals.rows
