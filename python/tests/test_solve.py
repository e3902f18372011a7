"""Optima beside enumeration and beside HiGHS; multipliers, starts, proofs and explanations."""

import doctest

import carom
import numpy as np
import pytest
from carom import _model, _prepared
from programs import enumerated, is_feasible, objective, random_integer_program

scipy = pytest.importorskip("scipy")
from scipy import sparse  # noqa: E402
from scipy.optimize import Bounds, LinearConstraint, milp  # noqa: E402


@pytest.mark.parametrize("module", [_model, _prepared])
def test_examples_of_docstrings(module):
    assert doctest.testmod(module).failed == 0


@pytest.mark.parametrize("kind", ["linear", "quadratic", "conic", "both"])
@pytest.mark.parametrize("seed", range(40))
def test_optima_are_those_of_enumeration(kind, seed):
    program = random_integer_program(seed, quadratic=kind in ("quadratic", "both"), cones=kind in ("conic", "both"))
    best, result = enumerated(program), carom.solve(**program)
    if best is None:
        assert result.status == "infeasible" and result.x is None and result.objective is None
        return
    assert result.status == "optimal"
    assert result.objective == pytest.approx(best, abs=1e-5)
    assert is_feasible(program, result.x, 1e-5)
    assert objective(program, result.x) == pytest.approx(result.objective, abs=1e-9)
    assert result.bound <= result.objective + 1e-9
    assert result.violation <= 1e-6


@pytest.mark.parametrize("seed", range(30))
def test_optima_are_those_of_highs(seed):
    random = np.random.default_rng(1000 + seed)
    n, m = 12, 8
    A = np.where(random.random((m, n)) < 0.6, random.normal(size=(m, n)), 0.0)
    q, u = random.normal(size=n), random.normal(size=m) + 2.0
    integrality = (random.random(n) < 0.5).astype(int)
    program = {"q": q, "A": sparse.csr_matrix(A), "u": u, "lb": -3.0, "ub": 5.0, "integrality": integrality}
    known = milp(q, constraints=LinearConstraint(A, -np.inf, u), bounds=Bounds(-3.0, 5.0), integrality=integrality)
    result = carom.solve(**program)
    assert (result.status == "optimal") == known.success
    if known.success:
        assert result.objective == pytest.approx(known.fun, rel=2e-4, abs=1e-5)
        assert result.objective <= known.fun + 1e-5


@pytest.mark.parametrize("form", ["dense", "list", "csr", "csc", "coo", "csr_array"])
def test_matrices_of_any_form_are_the_same(form):
    P, A = np.array([[2.0, 1.0], [1.0, 3.0]]), np.array([[1.0, 0.0], [1.0, 1.0]])
    convert = {"dense": np.asarray, "list": np.ndarray.tolist}.get(form) or getattr(sparse, form + ("" if "_" in form else "_matrix"))
    result = carom.solve(convert(P), [-8, -3], convert(A), None, [2, 2.5], lb=0)
    assert result.objective == pytest.approx(carom.solve(P, [-8, -3], A, None, [2, 2.5], lb=0).objective, abs=1e-7)
    assert result.objective == pytest.approx(-12.0 - 1.0 / 6.0, abs=1e-6)


def test_multipliers_are_derivatives():
    program = {"q": [1.0, 3.0], "A": [[2.0, 4.0], [0.0, 0.0]], "l": [12.0, -1.0], "lb": 0.0, "ub": 10.0}
    result = carom.solve(**program)
    more = carom.solve(**{**program, "l": [12.5, -1.0]})
    assert result.duals.rows[0] == pytest.approx((more.objective - result.objective) / 0.5, abs=1e-6)
    assert result.duals.rows.tolist() == pytest.approx([0.5, 0.0], abs=1e-6)
    assert result.duals.bounds.tolist() == pytest.approx([0.0, 1.0], abs=1e-6)


def test_integers_are_fixed_for_multipliers():
    bag = {"q": [-6.0, -7.0, -1.0], "A": [[3.0, 7.0, 1.0]], "u": 8.5, "lb": 0.0, "ub": 1.0, "integrality": [1, 1, 0]}
    result = carom.solve(**bag)
    assert result.duals is None
    fixed = result.fixed()
    assert fixed.objective == pytest.approx(result.objective, abs=1e-7)
    assert fixed.duals.rows.shape == (1,)
    relaxed = carom.Model(**bag).relaxed().solve()
    assert relaxed.objective <= result.objective + 1e-9
    assert relaxed.duals.rows[0] == pytest.approx(-1.0, abs=1e-6)
    with pytest.raises(ValueError, match="there is no point"):
        carom.solve(q=[1], A=[[1]], l=2, ub=1).fixed()


def test_unbounded_and_empty_programs():
    assert carom.solve(q=[1.0]).status == "unbounded"
    assert carom.solve(q=[1.0], A=[[0.0]], l=1.0, lb=0).status == "infeasible"
    assert carom.solve(q=[0.0], A=[[0.0]], u=1.0).status == "optimal"
    assert carom.solve(q=[1.0], lb=2.5, integrality=[True]).x.tolist() == [3.0]
    assert carom.solve(q=[0.0], cones=[([[0.0]], [3.0], None, 2.0)]).status == "infeasible"
    assert carom.solve(q=[1.0], cones=[([[1.0]], None, None, 2.0)]).x == pytest.approx([-2.0], abs=1e-5)


def test_a_start_is_used_and_never_trusted():
    program = random_integer_program(3, variables=6, rows=2)
    best = carom.solve(**program)
    again = carom.solve(**program, start=best.x)
    assert again.start == "accepted" and again.objective == best.objective
    wrong = carom.solve(**program, start=np.full(6, 77.0))
    assert wrong.objective == best.objective
    part = carom.solve(**program, start=np.where(np.arange(6) == 0, best.x, np.nan))
    assert part.objective == best.objective and best.start is None


def test_an_explanation_names_rows_cones_and_bounds():
    A = [[1, 0, 0], [1, 1, 0], [0, 0, 1], [0, 1, 1]]
    why = carom.solve(q=[0] * 3, A=A, l=[2, -9, 0, -9], u=[9, 1, 5, 9], lb=0, ub=10).explain()
    assert why.status == "irreducible" and why.rows == [0, 1] and 1 in why.bounds
    assert "row0" in str(why) and "row1" in why.names
    cone = carom.Model(q=[0, 0], A=[[1, 0]], l=3, cones=[(np.eye(2), None, None, 2.0)], lb=-5, ub=5).explain()
    assert cone.rows == [0] and cone.cones == [0]
    assert carom.Model(q=[1], lb=0).explain().status == "feasible"


def test_a_proof_is_written(tmp_path):
    path = tmp_path / "bag.proof"
    result = carom.solve(**random_integer_program(5), proof=path)
    assert path.exists() and result.proof["is_complete"] and result.proof["failure"] is None
    with pytest.raises(OSError, match="the proof cannot be written"):
        carom.solve(**random_integer_program(5), proof=tmp_path / "no" / "folder")


def test_a_log_is_printed(capfd):
    carom.solve(**random_integer_program(5), verbose=True)
    assert "optimal" in capfd.readouterr().out


def test_statistics_have_names():
    statistics = carom.solve(**random_integer_program(5)).statistics
    assert {"nodes", "iterations", "relaxations", "seconds"} <= set(statistics)
    assert "carom.Result: optimal" in repr(carom.solve(q=[1.0], lb=0))
