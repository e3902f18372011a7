"""carom under Pyomo; disjunctions through Pyomo's transformations."""

import carom
import pytest

pyo = pytest.importorskip("pyomo.environ")
results = pytest.importorskip("pyomo.contrib.solver.common.results")
from pyomo.contrib.solver.common.util import NoFeasibleSolutionError, NoOptimalSolutionError  # noqa: E402
from pyomo.gdp import Disjunct, Disjunction  # noqa: E402


def bag():
    model = pyo.ConcreteModel()
    model.take = pyo.Var(range(4), domain=pyo.Binary)
    values, weights = [6, 7, 4, 3], [3, 7, 2, 2]
    model.weight = pyo.Constraint(expr=sum(weights[k] * model.take[k] for k in range(4)) <= 9)
    model.value = pyo.Objective(expr=sum(values[k] * model.take[k] for k in range(4)) + 100, sense=pyo.maximize)
    return model


def test_a_point_is_loaded():
    model = bag()
    found = carom.Pyomo().solve(model, rel_gap=1e-6, time_limit=60, threads=2)
    assert [model.take[k].value for k in range(4)] == [1, 0, 1, 1]
    assert found.incumbent_objective == pytest.approx(113) and found.objective_bound >= 113 - 1e-3
    assert found.solution_status == results.SolutionStatus.optimal and found.solver_name == "carom"
    assert found.extra_info.statistics["nodes"] >= 0
    again = carom.Pyomo().solve(model, warmstart_discrete_vars=True, solver_options={"node_limit": 100})
    assert again.incumbent_objective == pytest.approx(113)


def test_the_factory_knows_it():
    import carom.pyomo  # noqa: F401

    model = bag()
    assert pyo.SolverFactory("carom").solve(model).solver.termination_condition == pyo.TerminationCondition.optimal


def test_infeasible_models_and_limits():
    model = bag()
    model.more = pyo.Constraint(expr=model.take[0] + model.take[1] >= 2)
    with pytest.raises(NoOptimalSolutionError):
        carom.Pyomo().solve(model)
    options = {"raise_exception_on_nonoptimal_result": False, "load_solutions": False}
    found = carom.Pyomo().solve(model, **options)
    assert found.termination_condition == results.TerminationCondition.provenInfeasible
    with pytest.raises(NoFeasibleSolutionError):
        found.solution_loader.load_vars()
    limited = carom.Pyomo().solve(bag(), time_limit=0, **options)
    assert limited.termination_condition == results.TerminationCondition.maxTimeLimit


def test_duals_are_loaded():
    model = pyo.ConcreteModel()
    model.x = pyo.Var([0, 1], bounds=(0, 10))
    model.need = pyo.Constraint(expr=2 * model.x[0] + 4 * model.x[1] >= 12)
    model.cost = pyo.Objective(expr=model.x[0] + 3 * model.x[1])
    model.dual, model.rc = pyo.Suffix(direction=pyo.Suffix.IMPORT), pyo.Suffix(direction=pyo.Suffix.IMPORT)
    carom.Pyomo().solve(model)
    assert model.dual[model.need] == pytest.approx(0.5, abs=1e-6)
    assert model.rc[model.x[1]] == pytest.approx(1.0, abs=1e-6)


def test_quadratic_rows_and_costs():
    model = pyo.ConcreteModel()
    model.x, model.y = pyo.Var(domain=pyo.Integers, bounds=(-5, 5)), pyo.Var(bounds=(-5, 5))
    model.disc = pyo.Constraint(expr=model.x**2 + model.y**2 <= 6)
    model.cost = pyo.Objective(expr=(model.x - 3) ** 2 + (model.y - 4) ** 2)
    found = carom.Pyomo().solve(model)
    best = min((x - 3) ** 2 + (y - 4) ** 2 for x in range(-2, 3) for y in [(6 - x**2) ** 0.5])
    assert found.incumbent_objective == pytest.approx(best, abs=1e-4)


def jobs(seed):
    """Jobs on one machine, in the order that a disjunction for each pair decides."""
    import random

    source = random.Random(seed)
    lengths, due = [source.randint(1, 5) for _ in range(4)], [source.randint(1, 12) for _ in range(4)]
    model = pyo.ConcreteModel()
    model.start, model.late = pyo.Var(range(4), bounds=(0, 20)), pyo.Var(range(4), bounds=(0, 20))
    model.lateness = pyo.Constraint(
        range(4), rule=lambda model, k: model.late[k] >= model.start[k] + lengths[k] - due[k]
    )
    pairs = [(i, j) for i in range(4) for j in range(i)]

    def order(disjunct, i, j, first):
        before, after = (i, j) if first else (j, i)
        disjunct.row = pyo.Constraint(expr=model.start[before] + lengths[before] <= model.start[after])

    model.order = Disjunct(pairs, [0, 1], rule=order)
    model.either = Disjunction(pairs, rule=lambda model, i, j: [model.order[i, j, 0], model.order[i, j, 1]])
    cost = sum((k + 1) * model.late[k] for k in range(4))
    model.cost = pyo.Objective(expr=cost + (model.late[0] ** 2 if seed % 2 else 0))
    import itertools

    def of(sequence):
        now = total = 0
        for k in sequence:
            now += lengths[k]
            late = max(0, now - due[k])
            total += (k + 1) * late + (late**2 if k == 0 and seed % 2 else 0)
        return total

    return model, min(map(of, itertools.permutations(range(4))))


@pytest.mark.parametrize("transformation", ["gdp.bigm", "gdp.hull"])
@pytest.mark.parametrize("seed", range(10))
def test_disjunctions_through_transformations(seed, transformation):
    model, best = jobs(seed)
    pyo.TransformationFactory(transformation).apply_to(model)
    found = carom.Pyomo().solve(model)
    assert found.incumbent_objective == pytest.approx(best, abs=1e-4)
