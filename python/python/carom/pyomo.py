"""carom as a solver of Pyomo: `carom.Pyomo().solve(model)`, or `pyo.SolverFactory("carom")` once this is imported.

Linear and convex quadratic objectives and rows, integers and ordered sets; disjunctions (`pyomo.gdp`) after one of
Pyomo's transformations. It is a solver of Pyomo's second interface (`pyomo.contrib.solver`).
"""

from __future__ import annotations

import datetime
import io
import time
from typing import Any, Mapping, Optional, Sequence

import numpy as np
from pyomo.common.collections import ComponentMap
from pyomo.common.config import ConfigValue
from pyomo.common.errors import InfeasibleConstraintException
from pyomo.common.tee import TeeStream, capture_output
from pyomo.contrib.solver.common.base import Availability, SolverBase
from pyomo.contrib.solver.common.config import BranchAndBoundConfig
from pyomo.contrib.solver.common.factory import SolverFactory
from pyomo.contrib.solver.common.results import Results, SolutionStatus, TerminationCondition, get_infeasible_results
from pyomo.contrib.solver.common.solution_loader import SolutionLoader
from pyomo.contrib.solver.common.util import (
    NoDualsError,
    NoFeasibleSolutionError,
    NoOptimalSolutionError,
    NoReducedCostsError,
)
from pyomo.core.staleflag import StaleFlagManager
from pyomo.repn.plugins.lp_writer import LPWriter

from . import _carom
from ._model import Model, Result

CONDITIONS = {
    "optimal": TerminationCondition.convergenceCriteriaSatisfied, "infeasible": TerminationCondition.provenInfeasible,
    "unbounded": TerminationCondition.unbounded, "time_limit": TerminationCondition.maxTimeLimit,
    "node_limit": TerminationCondition.iterationLimit, "interrupted": TerminationCondition.interrupted,
    "memory_limit": TerminationCondition.error,
}

# The variable by which Pyomo writes the constant of an objective.
CONSTANT = "ONE_VAR_CONSTANT"


class PyomoConfig(BranchAndBoundConfig):
    """Pyomo's options of such solvers, and whether values of variables are a start."""

    def __init__(self, **kwds: Any) -> None:
        super().__init__(**kwds)
        self.warmstart_discrete_vars = self.declare(
            "warmstart_discrete_vars",
            ConfigValue(default=False, domain=bool, description="Begin with the values of integers."),
        )


class Loader(SolutionLoader):
    """Values, duals and reduced costs of a result, by components of the model."""

    def __init__(self, model: Any, columns: Sequence[Any], rows: Sequence[Any], result: Result) -> None:
        self._pyomo_model, self._columns, self._rows, self._result = model, columns, rows, result

    def get_number_of_solutions(self) -> int:
        """1 if there is a point."""
        return int(self._result.x is not None)

    def get_vars(self, vars_to_load: Optional[Sequence[Any]] = None) -> Mapping[Any, float]:
        """Values of variables."""
        if self._result.x is None:
            raise NoFeasibleSolutionError()
        return self._of_columns(self._result.x, vars_to_load)

    def get_reduced_costs(self, vars_to_load: Optional[Sequence[Any]] = None) -> Mapping[Any, float]:
        """By how much the objective changes per unit by which the bounds move up."""
        if self._result.duals is None:
            raise NoReducedCostsError()
        return self._of_columns(self._result.duals.bounds, vars_to_load)

    def get_duals(self, cons_to_load: Optional[Sequence[Any]] = None) -> "dict[Any, float]":
        """By how much the objective changes per unit by which the limits of linear constraints move up."""
        if self._result.duals is None:
            raise NoDualsError()
        found: "dict[Any, float]" = {}
        for row, price in zip(self._rows, self._result.duals.rows):
            if row is not None:
                found[row] = found.get(row, 0.0) + float(price)
        return found if cons_to_load is None else {row: found[row] for row in cons_to_load}

    def _of_columns(self, numbers: np.ndarray, wanted: Optional[Sequence[Any]]) -> Mapping[Any, float]:
        found = ComponentMap(
            (column, float(number)) for column, number in zip(self._columns, numbers) if column is not None
        )
        return found if wanted is None else ComponentMap((column, found[column]) for column in wanted)


@SolverFactory.register("carom", doc="carom: mixed-integer linear, convex quadratic and conic programs, with proofs")
class Pyomo(SolverBase):
    """carom for Pyomo.

    Options of Pyomo: `time_limit` (s), `rel_gap`, `abs_gap`, `threads`, `tee`, `load_solutions`,
    `raise_exception_on_nonoptimal_result`, `warmstart_discrete_vars`. Those of `carom.solve` are `solver_options`:

        carom.Pyomo().solve(model, solver_options={"proof": "plan.proof", "node_limit": 1000})

    The results have the objective, the proved bound, and `extra_info`: `gap`, `violation`, `proof`, `statistics`.
    """

    CONFIG = PyomoConfig()

    def available(self) -> Availability:
        """It is there if it can be imported."""
        return Availability.FullLicense

    def version(self) -> "tuple[int, ...]":
        """The version of this package."""
        return tuple(int(part) for part in _carom.VERSION.split("."))

    def solve(self, model: Any, **kwds: Any) -> Results:
        """Solves a model and loads the best point, unless `load_solutions` is off."""
        began, tick = datetime.datetime.now(datetime.timezone.utc), time.perf_counter()
        config = self.config(value=kwds, preserve_implicit=True)
        StaleFlagManager.mark_all_as_stale()
        log = io.StringIO()
        try:
            with capture_output(TeeStream(log, *config.tee), capture_fd=False):
                results = self._solve(model, config)
        except InfeasibleConstraintException as error:
            results = get_infeasible_results(model, self, config, str(error))
        results.solver_name, results.solver_version, results.solver_config = self.name, self.version(), config
        results.solver_log = log.getvalue()
        results.timing_info.start_timestamp, results.timing_info.wall_time = began, time.perf_counter() - tick
        if config.raise_exception_on_nonoptimal_result and results.solution_status != SolutionStatus.optimal:
            raise NoOptimalSolutionError()
        if config.load_solutions:
            if not results.solution_loader.get_number_of_solutions():
                raise NoFeasibleSolutionError()
            results.solution_loader.load_solution()
        return results

    def _solve(self, model: Any, config: Any) -> Results:
        text = io.StringIO()
        symbols = LPWriter().write(model, text).symbol_map.bySymbol
        program, _ = _carom.Program.read(text.getvalue().encode(), "lp")
        read = Model._of(program)
        found = [symbols.get(name) for name in read.names]
        columns = [None if column is None or column.name == CONSTANT else column for column in found]
        rows = [symbols.get(name) for name in program.row_names()]
        options = {"time_limit": config.time_limit, "gap": config.rel_gap, "absolute_gap": config.abs_gap}
        options.update(threads=config.threads or 1, verbose=bool(config.tee), **config.solver_options)
        if config.warmstart_discrete_vars:
            values = [None if column is None else column.value for column in columns]
            options["start"] = np.array([np.nan if value is None else value for value in values])
        result = read.solve(**options)
        results = Results()
        results.solution_loader = Loader(model, columns, rows, result)
        results.termination_condition = CONDITIONS.get(result.status, TerminationCondition.unknown)
        if result.x is not None:
            is_optimal = result.status == "optimal"
            results.solution_status = SolutionStatus.optimal if is_optimal else SolutionStatus.feasible
            results.incumbent_objective = result.objective
        results.objective_bound = result.bound
        results.extra_info.gap, results.extra_info.violation = result.gap, result.violation
        results.extra_info.proof, results.extra_info.statistics = result.proof, result.statistics
        return results
