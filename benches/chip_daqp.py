"""The programs of `examples/chip_benchmarks` at the same states, solved by DAQP with branch and bound.

    python benches/chip_daqp.py FOLDER NAME...

FOLDER is that of `chip_benchmarks`: NAME.table states the program, NAME.states has states and their
least costs. Columns that equations fix are eliminated beforehand, as a code generator does, and the
workspace is set up once. The time of a state is what DAQP says of its own solve, without the update
of the limits. A cost counts as right if it is within 0.1 % of the least one; DAQP's default tolerances
and its regularisation of costs without curvature are kept. Needs numpy and daqp.
"""
import statistics
import sys

import daqp
import numpy as np

INFINITE = 1e30


class Program:
    """min 1/2 x'Px + q'x + offset over rows and bounds; some columns are the state."""

    def __init__(self, path):
        self.squares, self.rows, bounds = [], [], []
        with open(path) as file:
            for line in file:
                words = line.split()
                if words[0] == "c":
                    bounds.append((float(words[1]), float(words[2]), words[3] == "1"))
                elif words[0] == "axes":
                    self.axes = [int(word) for word in words[2:]]
                elif words[0] == "r":
                    terms = zip(words[4::2], words[5::2])
                    row = [(int(j), float(a)) for j, a in terms]
                    self.rows.append((float(words[1]), float(words[2]), row))
                elif words[0] == "cost":
                    self.offset = float(words[1])
                    self.linear = [(int(j), float(q)) for j, q in zip(words[3::2], words[4::2])]
                elif words[0] == "p":
                    self.squares.append((int(words[1]), int(words[2]), float(words[3])))
                elif words[0] == "lack":
                    break
        self.lower = np.array([bound[0] for bound in bounds])
        self.upper = np.array([bound[1] for bound in bounds])
        self.whole = np.array([bound[2] for bound in bounds])
        n = len(bounds)
        self.P, self.q = np.zeros((n, n)), np.zeros(n)
        for i, j, p in self.squares:
            self.P[i, j] = self.P[j, i] = p
        for j, q in self.linear:
            self.q[j] = q
        self.A = np.zeros((len(self.rows), n))
        for i, (_, _, row) in enumerate(self.rows):
            for j, a in row:
                self.A[i, j] = a

    def eliminate(self):
        """x = Z w + T t + c, where w are the columns that no equation fixes, and t is the state."""
        n = len(self.lower)
        is_axis = np.isin(np.arange(n), self.axes)
        equal = [i for i, (lower, upper, _) in enumerate(self.rows) if lower == upper]
        E = self.A[equal].copy()
        e = np.array([self.rows[i][0] for i in equal])
        fixed, left = {}, set()
        for k in range(len(equal)):
            may = [j for j in range(n) if not is_axis[j] and not self.whole[j] and j not in fixed]
            j = max(may, key=lambda j: abs(E[k, j]), default=None)
            if j is None or abs(E[k, j]) < 1e-9:
                # Of integers alone: it stays a row.
                left.add(equal[k])
                continue
            e[k], E[k] = e[k] / E[k, j], E[k] / E[k, j]
            for other in range(len(equal)):
                if other != k and E[other, j] != 0.0:
                    e[other] -= E[other, j] * e[k]
                    E[other] -= E[other, j] * E[k]
            fixed[j] = k
        free = [j for j in range(n) if not is_axis[j] and j not in fixed]
        Z, T, c = np.zeros((n, len(free))), np.zeros((n, len(self.axes))), np.zeros(n)
        for k, j in enumerate(free):
            Z[j, k] = 1.0
        for k, j in enumerate(self.axes):
            T[j, k] = 1.0
        for j, k in fixed.items():
            Z[j], T[j], c[j] = -E[k][free], -E[k][self.axes], e[k]
        self.used = set(equal) - left
        return free, Z, T, c


def solve(program, states):
    """Times, costs (None without a point) and nodes."""
    free, Z, T, c = program.eliminate()
    H = Z.T @ program.P @ Z
    others = [i for i in range(len(program.rows)) if i not in program.used]
    A = program.A[others]
    row_lower = np.array([program.rows[i][0] for i in others])
    row_upper = np.array([program.rows[i][1] for i in others])
    axes = set(program.axes)
    bounded = [j for j in range(len(c)) if j not in free and j not in axes]
    dense = np.ascontiguousarray(np.vstack([A @ Z, Z[bounded]]))
    sense = np.zeros(len(free) + len(dense), dtype=np.int32)
    sense[: len(free)] = np.where(program.whole[free], 16, 0)
    for k, equal in enumerate(row_lower == row_upper):
        sense[len(free) + k] = 5 if equal else 0
    solver = daqp.Model()
    times, costs, nodes = [], [], []
    for k, t in enumerate(states):
        base = T @ t + c
        f = Z.T @ (program.P @ base + program.q)
        upper = [program.upper[free], row_upper - A @ base, program.upper[bounded] - base[bounded]]
        lower = [program.lower[free], row_lower - A @ base, program.lower[bounded] - base[bounded]]
        upper = np.clip(np.concatenate(upper), -INFINITE, INFINITE)
        lower = np.clip(np.concatenate(lower), -INFINITE, INFINITE)
        if k == 0:
            solver.setup(H, f, dense, upper, lower, sense.copy())
        else:
            solver.update(f=f, bupper=upper, blower=lower, sense=sense.copy())
        w, _, flag, info = solver.solve()
        times.append(info["solve_time"])
        nodes.append(info["nodes"])
        x = Z @ w + base
        cost = 0.5 * x @ program.P @ x + program.q @ x + program.offset
        costs.append(cost if flag > 0 else None)
    return times, costs, nodes


def main():
    folder, *names = sys.argv[1:]
    print("system       states  median us  longest us  nodes  right  dearer  cheaper  no answer  no plan")
    for name in names:
        program = Program(f"{folder}/{name}.table")
        states, least = [], []
        with open(f"{folder}/{name}.states") as file:
            for line in file:
                *state, cost = line.split()
                states.append(np.array([float(x) for x in state]))
                least.append(None if cost == "none" else float(cost))
        times, costs, nodes = solve(program, states)
        right = dearer = cheaper = missed = none = 0
        for own, best in zip(costs, least):
            if best is None:
                none += own is None
                missed += own is not None
            elif own is None:
                missed += 1
            elif abs(own - best) <= 1e-3 * (1.0 + abs(best)):
                right += 1
            else:
                dearer += own > best
                cheaper += own < best
        micro = [1e6 * time for time in times]
        print(
            f"{name:11}  {len(states):6}  {statistics.median(micro):9.1f}  {max(micro):10.1f}"
            f"  {max(nodes):5}  {right:5}  {dearer:6}  {cheaper:7}  {missed:9}  {none:7}"
        )


if __name__ == "__main__":
    main()
