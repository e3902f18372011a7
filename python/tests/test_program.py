"""The program `carom` as a solver of AMPL, with Pyomo as the caller: NL files there, SOL files back.

`CAROM_PROGRAM` is the path of the program; else it is the one in the `PATH`, or a build of this repository.
"""

import math
import os
import random
import shutil
from pathlib import Path

import pytest

pyo = pytest.importorskip("pyomo.environ")
from pyomo.gdp import Disjunction  # noqa: E402


def find():
    target = Path(os.environ.get("CARGO_TARGET_DIR") or Path(__file__).parents[2] / "target")
    builds = [str(target / profile / "carom") for profile in ("release", "debug")]
    found = [os.environ.get("CAROM_PROGRAM"), shutil.which("carom"), *filter(os.path.exists, builds)]
    return next(filter(None, found), None)


PROGRAM = find()
pytestmark = pytest.mark.skipif(PROGRAM is None, reason="the program `carom` is not built (cargo build -p carom-cli)")
Condition = pyo.TerminationCondition


def solve(model, **options):
    solver = pyo.SolverFactory("asl", executable=PROGRAM, solver=PROGRAM)
    return solver.solve(model, options=options, load_solutions=False)


def solved(model, **options):
    """Solves a model to the optimum, and loads the values."""
    found = solve(model, **options)
    assert found.solver.termination_condition == Condition.optimal, found.solver.message
    model.solutions.load_from(found)
    return pyo.value(next(model.component_data_objects(pyo.Objective, active=True)))


def bag():
    model = pyo.ConcreteModel()
    model.take = pyo.Var(range(4), domain=pyo.Binary)
    values, weights = [6, 7, 4, 3], [3, 7, 2, 2]
    model.weight = pyo.Constraint(expr=sum(weights[k] * model.take[k] for k in range(4)) <= 9)
    model.value = pyo.Objective(expr=sum(values[k] * model.take[k] for k in range(4)) + 100, sense=pyo.maximize)
    return model


def test_pyomo_knows_the_version():
    assert pyo.SolverFactory("asl", executable=PROGRAM, solver=PROGRAM).version()[:2] == (0, 1)


def test_an_integer_program():
    model = bag()
    assert solved(model, timelim=60, mipgap=1e-6, threads=2) == pytest.approx(113)
    assert [model.take[k].value for k in range(4)] == [1, 0, 1, 1]
    # The values are where the next search begins.
    assert solved(model) == pytest.approx(113)


def test_how_a_search_ends():
    model = bag()
    model.more = pyo.Constraint(expr=model.take[0] + model.take[1] >= 2)
    assert solve(model).solver.termination_condition == Condition.infeasible
    model = pyo.ConcreteModel()
    model.x = pyo.Var()
    model.cost = pyo.Objective(expr=model.x)
    assert solve(model).solver.termination_condition == Condition.unbounded
    assert solve(bag(), timelim=0).solver.termination_condition == Condition.maxIterations


def test_failures_say_what_and_where():
    model = bag()
    model.curve = pyo.Constraint(expr=pyo.floor(model.take[0]) + model.take[1] <= 2)
    found = solve(model)
    assert found.solver.termination_condition == Condition.internalSolverError
    assert "`floor` is not taken" in found.solver.message and "[unsupported]" in found.solver.message
    found = solve(bag(), colour="red")
    assert "no option is called `colour`" in found.solver.message


def test_nonlinear_functions():
    model = pyo.ConcreteModel()
    model.x, model.n = pyo.Var(bounds=(-3, 3)), pyo.Var(domain=pyo.Integers, bounds=(1, 4))
    model.wave = pyo.Constraint(expr=pyo.sin(model.x) * model.n >= 1)
    model.cost = pyo.Objective(expr=pyo.exp(model.x) / model.n + 0.2 * model.n)
    best = min(math.exp(math.asin(1 / n)) / n + 0.2 * n for n in range(1, 5))
    assert solved(model, mipgap=1e-6) == pytest.approx(best, abs=1e-4)


def test_quadratic_rows_and_costs():
    model = pyo.ConcreteModel()
    model.x, model.y = pyo.Var(domain=pyo.Integers, bounds=(-5, 5)), pyo.Var(bounds=(-5, 5))
    model.half = pyo.Expression(expr=model.y / 2 - 1)
    model.disc = pyo.Constraint(expr=model.x**2 + 4 * (model.half + 1) ** 2 <= 6)
    model.cost = pyo.Objective(expr=(model.x - 3) ** 2 + (2 * model.half - 2) ** 2)
    best = min((x - 3) ** 2 + (y - 4) ** 2 for x in range(-2, 3) for y in [(6 - x**2) ** 0.5])
    assert solved(model) == pytest.approx(best, abs=1e-4)


def test_multipliers():
    model = pyo.ConcreteModel()
    model.x = pyo.Var([0, 1], bounds=(0, 10))
    model.need = pyo.Constraint(expr=2 * model.x[0] + 4 * model.x[1] >= 12)
    model.more = pyo.Constraint(expr=model.x[0] - model.x[1] <= 30)
    model.cost = pyo.Objective(expr=model.x[0] + 3 * model.x[1])
    model.dual = pyo.Suffix(direction=pyo.Suffix.IMPORT)
    assert solved(model) == pytest.approx(6, abs=1e-6)
    assert model.dual[model.need] == pytest.approx(0.5, abs=1e-6)
    assert model.dual[model.more] == pytest.approx(0, abs=1e-6)


def test_ordered_sets():
    model = pyo.ConcreteModel()
    model.x = pyo.Var(range(3), bounds=(0, 1))
    model.cost = pyo.Objective(expr=3 * model.x[0] + 2 * model.x[1] + 2 * model.x[2], sense=pyo.maximize)
    model.one = pyo.SOSConstraint(var=model.x, sos=1)
    assert solved(model) == pytest.approx(3, abs=1e-6)
    model.del_component("one")
    model.two = pyo.SOSConstraint(var=model.x, sos=2)
    assert solved(model) == pytest.approx(5, abs=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_the_same_as_the_other_way_to_pyomo(seed):
    """Random mixed-integer programs with costs that are quadratic, and disjunctions."""
    carom = pytest.importorskip("carom")
    source = random.Random(seed)
    model = pyo.ConcreteModel()
    model.x = pyo.Var(range(3), bounds=(-4, 4))
    model.n = pyo.Var(range(3), domain=pyo.Integers, bounds=(-3, 5))
    both = [*model.x.values(), *model.n.values()]

    def row():
        return sum(source.randint(-3, 4) * own for own in both) + 0.5 * both[source.randrange(6)]

    model.rows = pyo.Constraint(range(3), rule=lambda model, k: (-20, row(), source.randint(1, 9)))
    model.side = Disjunction(expr=[[row() <= -1], [row() >= 2, model.x[0] >= 1]])
    squares = sum((own - source.randint(-2, 2)) ** 2 for own in both[seed % 2 :: 2]) if seed % 3 else 0
    model.cost = pyo.Objective(expr=row() + squares)
    pyo.TransformationFactory("gdp.bigm").apply_to(model)
    other = carom.Pyomo().solve(model, load_solutions=False).incumbent_objective
    assert solved(model) == pytest.approx(other, abs=1e-4)
