"""carom under CVXPY: CVXPY's own tests of solvers, random problems beside HiGHS and SCIP, and what users see."""

import itertools
import warnings

import carom
import numpy as np
import pytest

cp = pytest.importorskip("cvxpy")
from cvxpy.tests import solver_test_helpers as standard  # noqa: E402
from programs import market_split  # noqa: E402

# Not for every solver: `test_lp_7` is about another solver's numbers, `test_qp_bound_attr` reads the data of solvers
# without cones, and power cones are no second-order cones (CVXPY approximates some).
ELSEWHERE = {"test_lp_7", "test_qp_bound_attr"}
STANDARD = [
    (group, name)
    for group in (standard.StandardTestLPs, standard.StandardTestQPs, standard.StandardTestSOCPs)
    for name in dir(group)
    if name.startswith("test_") and name not in ELSEWHERE
]


@pytest.mark.parametrize("group, name", STANDARD, ids=[f"{group.__name__}.{name}" for group, name in STANDARD])
def test_of_cvxpy_itself(group, name):
    getattr(group, name)(carom.CVXPY())


def random_problem(seed):
    """A problem, and the solver beside which it is solved."""
    random = np.random.default_rng(seed)
    n, m = 6, 4
    x, z = cp.Variable(n, integer=True), cp.Variable(3, boolean=True)
    y = cp.Variable(n, bounds=[-4, 4])
    A, B, C = (random.integers(-3, 4, (m, k)).astype(float) for k in (n, n, 3))
    side = A @ random.integers(-2, 3, n) + B @ random.integers(-2, 3, n)
    constraints = [A @ x + B @ y + C @ z <= side + random.integers(1, 5, m), x >= -3, x <= 3, cp.sum(z) >= 1]
    costs = random.normal(size=n) @ x + random.normal(size=n) @ y + random.normal(size=3) @ z
    kind = seed % 4
    if kind == 0:
        return cp.Problem(cp.Minimize(costs + cp.norm1(x - y)), constraints), "HIGHS"
    if kind == 1:
        return cp.Problem(cp.Maximize(costs), constraints), "HIGHS"
    if kind == 2:
        return cp.Problem(cp.Minimize(costs + cp.sum_squares(x - y) / 2), constraints), "SCIP"
    disc = cp.norm(random.normal(size=(3, n)) @ y) <= 3 + z[0]
    return cp.Problem(cp.Minimize(costs + cp.norm(x[:3] - y[:3])), [*constraints, disc]), "SCIP"


@pytest.mark.parametrize("seed", range(100))
def test_random_problems_have_the_optima_of_others(seed):
    problem, other = random_problem(seed)
    if other not in cp.installed_solvers():
        pytest.skip(f"{other} is not installed")
    problem.solve(solver=carom.CVXPY())
    status, value = problem.status, problem.value
    assert all(constraint.violation().max() < 1e-4 for constraint in problem.constraints if value is not None)
    problem.solve(solver=other)
    assert status == problem.status
    if status == "optimal":
        assert value == pytest.approx(problem.value, rel=1e-3, abs=1e-4)


def test_duals_are_those_of_another_solver():
    random = np.random.default_rng(3)
    for _ in range(10):
        x = cp.Variable(4)
        A, b = random.normal(size=(6, 4)), random.random(6)
        constraints = [A @ x <= b, cp.norm(x) <= 2.0, cp.sum(x) == 0.3]
        problem = cp.Problem(cp.Minimize(random.normal(size=4) @ x + cp.sum_squares(x)), constraints)
        problem.solve(solver=carom.CVXPY())
        values = [np.hstack([np.ravel(part) for part in np.atleast_1d(c.dual_value)]) for c in constraints if c.dual_value is not None]
        problem.solve(solver=cp.CLARABEL)
        others = [np.hstack([np.ravel(part) for part in np.atleast_1d(c.dual_value)]) for c in constraints]
        assert len(values) == 3
        for value, other in zip(values, others):
            assert value == pytest.approx(other, abs=1e-3)


def test_semidefinite_and_exponential_cones_are_refused():
    X, x = cp.Variable((2, 2), PSD=True), cp.Variable()
    for problem in (cp.Problem(cp.Minimize(cp.trace(X))), cp.Problem(cp.Minimize(cp.exp(x)))):
        with pytest.raises(cp.error.SolverError):
            problem.solve(solver=carom.CVXPY())


def hard():
    program = market_split()
    whole = program["integrality"].astype(bool)
    x, slack = cp.Variable(whole.sum(), boolean=True), cp.Variable((~whole).sum(), nonneg=True)
    sides = program["A"][:, whole] @ x + program["A"][:, ~whole] @ slack
    return cp.Problem(cp.Minimize(cp.sum(slack)), [sides == program["l"]])


def test_limits_keep_the_best_values():
    problem = hard()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        problem.solve(solver=carom.CVXPY(), time_limit=1)
    stats = problem.solver_stats.extra_stats
    assert problem.status == "user_limit" and problem.variables()[0].value is not None
    assert stats["status"] == "time_limit" and stats["bound"] <= problem.value and stats["gap"] > 0
    with pytest.raises(cp.error.SolverError, match="no point before it stopped"):
        hard().solve(solver=carom.CVXPY(), time_limit=0)


def test_values_are_starts():
    problem = hard()
    x = problem.variables()[0] if problem.variables()[0].attributes["boolean"] else problem.variables()[1]
    x.value = np.zeros(x.size)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        problem.solve(solver=carom.CVXPY(node_limit=5))
    assert problem.solver_stats.extra_stats["start"] == "accepted"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        problem.solve(solver=carom.CVXPY(node_limit=5), warm_start=False)
    assert problem.solver_stats.extra_stats["start"] is None


def test_options_have_names(tmp_path):
    x = cp.Variable(integer=True)
    problem = cp.Problem(cp.Minimize(x), [x >= 1.5])
    problem.solve(solver=carom.CVXPY(threads=2), proof=tmp_path / "x.proof", gap=1e-3)
    assert problem.value == 2.0 and problem.solver_stats.extra_stats["proof"]["is_complete"]
    assert (tmp_path / "x.proof").exists()
    with pytest.raises(TypeError, match="there is no option `speed`"):
        problem.solve(solver=carom.CVXPY(), speed=9)


def test_parameters_change_from_solve_to_solve():
    x, wanted = cp.Variable(2, integer=True), cp.Parameter(2)
    problem = cp.Problem(cp.Minimize(cp.sum_squares(x - wanted)), [cp.sum(x) <= 5, x >= 0])
    for value in ([1.2, 3.9], [4.0, 4.0], [0.4, 0.6]):
        wanted.value = np.array(value)
        problem.solve(solver=carom.CVXPY(), enforce_dpp=True)
        points = ((a, b) for a in range(6) for b in range(6 - a))
        best = min((a - value[0]) ** 2 + (b - value[1]) ** 2 for a, b in points)
        assert problem.value == pytest.approx(best, abs=1e-5)


def test_a_problem_that_comes_again_is_prepared():
    random = np.random.default_rng(4)
    x, start, prices = cp.Variable(3, integer=True), cp.Parameter(2), cp.Parameter(3)
    lower = cp.Parameter(3)
    A = np.array([[2.0, 1.0, -1.0], [1.0, 3.0, 2.0]])
    problem = cp.Problem(cp.Minimize(prices @ x + cp.sum_squares(x)), [A @ x >= start, x >= lower, x <= 3])
    solver = carom.CVXPY()
    prices.value = np.ones(3)
    for solve in range(14):
        start.value = np.round(random.normal(size=2) * (1.0 + solve), 1)
        lower.value = random.integers(-3, 1, 3).astype(float)
        if solve % 5 == 4:
            prices.value = np.round(random.normal(size=3), 1)
        problem.solve(solver=solver, enforce_dpp=True)
        points = itertools.product(*(range(int(low), 4) for low in lower.value))
        costs = (prices.value @ x + np.sum(np.square(x)) for x in points if (A @ x >= start.value - 1e-9).all())
        best = min(costs, default=None)
        assert problem.status == ("infeasible" if best is None else "optimal")
        if best is not None:
            assert problem.value == pytest.approx(best, abs=1e-5)
    assert problem._solver_cache["CAROM"]._prepared is not None
    problem.solve(solver=solver, warm_start=False)
    assert problem.status == ("infeasible" if best is None else "optimal")


def test_bounds_that_cross_are_infeasible():
    lower = cp.Parameter(value=2.0)
    x = cp.Variable(bounds=[lower, 3.0])
    problem = cp.Problem(cp.Minimize(x))
    problem.solve(solver=carom.CVXPY())
    assert problem.value == pytest.approx(2.0, abs=1e-6)
    lower.value = 4.0
    problem.solve(solver=carom.CVXPY())
    assert problem.status == "infeasible"
