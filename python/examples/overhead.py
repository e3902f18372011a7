"""What a call from Python costs beyond the call of the solver: a prepared program of 100 columns, 1,000 times.

    python python/examples/overhead.py
"""

import time

import carom
import numpy as np

random = np.random.default_rng(1)
columns, rows, times = 100, 10, 1000
A = np.where(random.random((rows, columns)) < 0.2, random.random((rows, columns)), 0.0)
need = A.sum(axis=1) * 0.4
integrality = (np.arange(columns) < 5).astype(int)
prepared = carom.Prepared(
    q=random.random(columns) + 0.5, A=A, l=need, lb=0, ub=1, integrality=integrality, ranges={"l": (0, need + 1)}
)
needs = [need * (1.0 + 0.001 * random.random(rows)) for _ in range(times)]
prepared.solve(l=need)

walls, calls = [], []
for side in needs:
    began = time.perf_counter()
    result = prepared.solve(l=side)
    x = result.x
    walls.append(time.perf_counter() - began)
    calls.append(result.seconds)
    assert result.status == "optimal"
walls, calls = 1e6 * np.array(walls), 1e6 * np.array(calls)
beyond = walls - calls
print(f"a call from Python  {np.median(walls):9.1f} µs (mean {walls.mean():9.1f})")
print(f"the solver in it    {np.median(calls):9.1f} µs (mean {calls.mean():9.1f})")
print(f"beyond the solver   {np.median(beyond):9.1f} µs (mean {beyond.mean():9.1f}, quartiles "
      f"{np.quantile(beyond, 0.25):.1f} to {np.quantile(beyond, 0.75):.1f})")
