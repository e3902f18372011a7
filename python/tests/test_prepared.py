"""Programs that are solved again and again: the answers of solves from nothing."""

import carom
import numpy as np
import pytest
from programs import enumerated, random_integer_program


@pytest.mark.parametrize("quadratic", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_answers_are_those_of_enumeration(seed, quadratic):
    random = np.random.default_rng(seed)
    program = random_integer_program(seed, quadratic=quadratic)
    names = ("l", "u", "lb", "ub")
    ranges = {
        "l": (program["l"] - 3, program["l"] + 3), "u": (program["u"] - 3, program["u"] + 3),
        "lb": (program["lb"], program["lb"] + 2), "ub": (program["ub"] - 2, program["ub"]),
    }
    prepared, equations = carom.Prepared(**program, ranges=ranges), program["l"] == program["u"]
    for solve in range(12):
        now = {name: np.round(random.uniform(*ranges[name])) for name in names}
        now["u"], now["ub"] = np.maximum(now["l"], now["u"]), np.maximum(now["lb"], now["ub"])
        now["u"] = np.where(equations, now["l"], now["u"])
        if solve % 4 == 3:
            now["q"] = random.integers(-5, 6, len(program["q"])).astype(float)
            now["offset"] = float(solve)
        program.update(now)
        result, best = prepared.solve(**now), enumerated(program)
        assert result.status == ("infeasible" if best is None else "optimal")
        if best is not None:
            assert result.objective == pytest.approx(best, abs=1e-5)


def test_equations_stay_equations():
    prepared = carom.Prepared(q=[1, 2], A=[[1, 1]], l=3, u=3, lb=0, ub=9, integrality=[1, 1], ranges={"l": (0, 9), "u": (0, 9)})
    assert [prepared.solve(l=side, u=side).objective for side in (3, 5, 9)] == [3.0, 5.0, 9.0]
    with pytest.raises(ValueError, match="prepared as an equation"):
        prepared.solve(l=2, u=4)
    assert prepared.solve().objective == 9.0


def test_numbers_without_a_range_stay():
    prepared = carom.Prepared(q=[1, 1], A=[[1, 0], [0, 1]], l=[1, 2], lb=0, ranges={"l": ([0, 2], [5, 2])})
    assert prepared.solve(l=[3, 2]).objective == pytest.approx(5.0, abs=1e-6)
    for given, text in (
        ({"l": [3, 1]}, r"`l\[1\]` is 1 and was prepared as 2"), ({"l": [6, 2]}, "was prepared for 0 to 5"),
        ({"lb": 1}, r"`lb\[0\]` is 1"), ({"l": [float("nan"), 2]}, "is NaN"), ({"l": [1]}, "has the shape"),
        ({"q": [float("inf"), 0]}, r"`q\[0\]` is inf"), ({"speed": 1}, "no option"),
    ):
        with pytest.raises((TypeError, ValueError), match=text):
            prepared.solve(**given)
    assert prepared.solve().objective == pytest.approx(5.0, abs=1e-6)


@pytest.mark.parametrize(
    "ranges, text",
    [
        ({"q": (0, 1)}, "`q` needs none"), ({"l": 3}, "must be a pair"), ({"l": (5, 6)}, r"hold `l\[0\]`"),
        ({"l": (0, float("inf"))}, "must be finite"),
    ],
)
def test_wrong_ranges_are_exceptions(ranges, text):
    with pytest.raises((TypeError, ValueError), match=text):
        carom.Prepared(q=[1], A=[[1]], l=1, ranges=ranges)


def test_multipliers_and_explanations_are_of_the_numbers():
    prepared = carom.Prepared(q=[1, 1], A=[[1, 1]], l=4, lb=0, ub=5, ranges={"l": (0, 20), "lb": (0, 8), "ub": (0, 8)})
    result = prepared.solve(l=6, lb=[1, 0])
    assert result.objective == pytest.approx(6.0, abs=1e-6)
    assert result.duals.rows == pytest.approx([1.0], abs=1e-6)
    why = prepared.solve(l=11, lb=0).explain()
    assert why.rows == [0] and why.status == "irreducible"
    assert result.fixed().objective == pytest.approx(6.0, abs=1e-6)


def test_a_last_point_is_the_next_start():
    prepared = carom.Prepared(q=[1, 3], A=[[1, 2]], l=4, lb=0, ub=[3, 9], integrality=[1, 1], ranges={"l": (0, 15)})
    assert prepared.solve().start is None
    assert prepared.solve(q=[2, 3]).start == "accepted"
    assert prepared.solve(start=[3, 1]).start is not None
