"""Mixed-integer linear, convex quadratic and second-order cone programs, solved with proofs.

`solve` takes the arrays of a program; `Model` keeps them, `read` takes them from a file, and `Prepared` is for a
program that is solved again and again. `HybridSystem`, `Scene`, `Mission` and `RecedingHorizon` plan for systems whose
dynamics switch. `carom.CVXPY()` is a solver for CVXPY, which has to be installed for it:

    problem.solve(solver=carom.CVXPY())

and `carom.Pyomo()` is one for Pyomo.

Every answer is checked against the program as it was given, by code that shares nothing with the search, and its
bound is proved; `proof="file"` writes that proof for another program to check.
"""

from ._carom import VERSION as __version__
from ._model import Duals, Explanation, Model, Result, read, solve
from ._planner import (
    ControlMove, Expression, HybridPlan, HybridProgram, HybridSystem, Mission, RecedingHorizon, Row, Scene,
    ShortestHorizon, ShortestInScene, Transition, norm,
)
from ._prepared import Prepared
from ._settings import Incumbent

__all__ = [
    "CVXPY", "ControlMove", "Duals", "Explanation", "Expression", "HybridPlan", "HybridProgram", "HybridSystem",
    "Incumbent", "Mission", "Model", "Prepared", "Pyomo", "RecedingHorizon", "Result", "Row", "Scene",
    "ShortestHorizon", "ShortestInScene", "Transition", "norm", "read", "solve",
]


def __getattr__(name: str) -> object:
    """Imports what needs other packages when it is asked for."""
    if name == "CVXPY":
        from .cvxpy import CVXPY

        return CVXPY
    if name == "Pyomo":
        from .pyomo import Pyomo

        return Pyomo
    raise AttributeError(f"module `carom` has no `{name}`")


def __dir__() -> "list[str]":
    return sorted(__all__)
