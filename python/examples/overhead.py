"""What a call from Python costs beyond the call of the solver: a prepared program of 100 columns, 1,000 times.

    python python/examples/overhead.py
"""

import time

import carom
import numpy as np

COLUMNS, ROWS, TIMES = 100, 10, 1000


def measure(integers):
    """Solves a covering program with other right sides each time, and prints medians (µs)."""
    random = np.random.default_rng(1)
    A = np.where(random.random((ROWS, COLUMNS)) < 0.2, random.random((ROWS, COLUMNS)), 0.0)
    need = A.sum(axis=1) * 0.4
    prepared = carom.Prepared(
        q=random.random(COLUMNS) + 0.5, A=A, l=need, lb=0, ub=1, ranges={"l": (0, need + 1)},
        integrality=(np.arange(COLUMNS) < integers).astype(int),
    )
    needs = [need * (1.0 + 0.001 * random.random(ROWS)) for _ in range(TIMES)]
    prepared.solve(l=need)
    walls, calls = [], []
    for side in needs:
        began = time.perf_counter()
        result = prepared.solve(l=side)
        result.x
        walls.append(time.perf_counter() - began)
        calls.append(result.seconds)
        assert result.status == "optimal"
    walls, calls = 1e6 * np.array(walls), 1e6 * np.array(calls)
    beyond = np.quantile(walls - calls, [0.1, 0.25, 0.5, 0.75])
    print(
        f"{integers} integers: a call {np.median(walls):.0f} µs, the solver in it {np.median(calls):.0f} µs, beyond it"
        f" {beyond[2]:.0f} µs (10 % at most {beyond[0]:.0f}, 25 % {beyond[1]:.0f}, 75 % {beyond[3]:.0f})"
    )


for integers in (0, 5):
    measure(integers)
