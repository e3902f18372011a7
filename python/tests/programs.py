"""Programs for the tests, from fixed seeds, and optima that share nothing with carom."""

import itertools

import numpy as np


def random_integer_program(seed, variables=4, rows=3, quadratic=False, cones=False):
    """A program in integers from -2 to 2 that has a point most of the time; a dictionary of arguments."""
    random = np.random.default_rng(seed)
    A = random.integers(-3, 4, (rows, variables)).astype(float)
    inside = A @ random.integers(-2, 3, variables)
    program = {
        "q": random.integers(-5, 6, variables).astype(float), "A": A,
        "l": inside - random.integers(0, 4, rows), "u": inside + random.integers(0, 4, rows),
        "lb": np.full(variables, -2.0), "ub": np.full(variables, 2.0), "integrality": np.ones(variables, dtype=int),
        "offset": float(random.integers(-3, 4)),
    }
    if quadratic:
        factor = random.integers(-2, 3, (variables, variables)).astype(float)
        program["P"] = factor.T @ factor
    if cones:
        C = random.integers(-2, 3, (2, variables)).astype(float)
        e = random.integers(-1, 2, variables).astype(float)
        program["cones"] = [(C, random.integers(-1, 2, 2).astype(float), e, 4.5)]
    return program


def objective(program, x):
    """The objective at a point."""
    P = program.get("P")
    squares = 0.0 if P is None else 0.5 * x @ P @ x
    return squares + program["q"] @ x + program.get("offset", 0.0)


def is_feasible(program, x, tolerance=1e-9):
    """Whether a point keeps rows, bounds and cones."""
    sides = program["A"] @ x
    holds = (sides >= program["l"] - tolerance).all() and (sides <= program["u"] + tolerance).all()
    holds = holds and (x >= program["lb"] - tolerance).all() and (x <= program["ub"] + tolerance).all()
    for C, d, e, f in program.get("cones", []):
        holds = holds and np.linalg.norm(C @ x + d) <= e @ x + f + tolerance
    return bool(holds)


def enumerated(program):
    """The best objective over all integers within the bounds, or `None`."""
    ranges = [range(int(low), int(high) + 1) for low, high in zip(program["lb"], program["ub"])]
    points = (np.array(point, dtype=float) for point in itertools.product(*ranges))
    return min((objective(program, x) for x in points if is_feasible(program, x)), default=None)


def market_split(rows=5, seed=1):
    """A program that nobody solves soon, with points that are easy to find."""
    random = np.random.default_rng(seed)
    columns = 10 * (rows - 1)
    split = random.integers(0, 100, (rows, columns)).astype(float)
    side = np.floor(split.sum(axis=1) / 2.0)
    slack = np.eye(rows)
    return {
        "q": np.concatenate((np.zeros(columns), np.ones(2 * rows))),
        "A": np.hstack((split, slack, -slack)), "l": side, "u": side,
        "lb": 0.0, "ub": np.concatenate((np.ones(columns), np.full(2 * rows, 1e4))),
        "integrality": np.concatenate((np.ones(columns), np.zeros(2 * rows))),
    }
