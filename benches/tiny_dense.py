"""Tiny convex quadratic programs with binaries, as MPS files for `compare.py`.

    python3 benches/tiny_dense.py target/tiny [SEED] [COUNT]
    target/peers/bin/python benches/compare.py target/tiny --cpu --rounds 5 --peers daqp highs gurobi

Two families, COUNT (24) programs each from SEED (1), a folder each. `dense`: every row and the cost are
dense; 8 to 24 columns within 10 of 0, 4 to 10 binaries, 10 to 29 rows. `loops`: plans of a system of 2 to 6
states, each row of whose matrix is random, under one force for 3 to 8 steps; in each of 2 to 8 first
steps, a binary adds a push, and only where it is 1 may the first state fall. Needs no packages.
"""
import os
import random
import sys


class Program:
    def __init__(self):
        self.columns, self.rows, self.squares = [], [], {}

    def column(self, lower, upper, cost=0.0, whole=False):
        self.columns.append((lower, upper, cost, whole))
        return len(self.columns) - 1

    def row(self, terms, kind, limit):
        self.rows.append(([(j, a) for j, a in terms if a != 0.0], kind, limit))

    def write(self, path):
        """The cost is the linear one and half of the squares (`QUADOBJ`: the lower triangle)."""
        entries = [[] for _ in self.columns]
        for i, (terms, _, _) in enumerate(self.rows):
            for j, a in terms:
                entries[j].append((f"r{i}", a))
        lines = ["NAME tiny", "ROWS", " N cost"]
        lines += [f" {kind} r{i}" for i, (_, kind, _) in enumerate(self.rows)]
        lines.append("COLUMNS")
        for wanted, marker in [(False, None), (True, "INTORG")]:
            if marker:
                lines.append(" M1 'MARKER' 'INTORG'")
            for j, (_, _, cost, whole) in enumerate(self.columns):
                if whole == wanted:
                    lines += [f" x{j} {row} {a!r}" for row, a in [("cost", cost), *entries[j]]]
            if marker:
                lines.append(" M2 'MARKER' 'INTEND'")
        lines.append("RHS")
        lines += [f" rhs r{i} {limit!r}" for i, (_, _, limit) in enumerate(self.rows)]
        lines.append("BOUNDS")
        for j, (lower, upper, _, _) in enumerate(self.columns):
            lines += [f" LO b x{j} {lower!r}", f" UP b x{j} {upper!r}"]
        lines.append("QUADOBJ")
        lines += [f" x{j} x{i} {q!r}" for (i, j), q in sorted(self.squares.items()) if q != 0.0]
        lines.append("ENDATA")
        with open(path, "w") as file:
            file.write("\n".join(lines) + "\n")


def dense(numbers):
    program = Program()
    plain, binaries, rows = numbers.randint(8, 24), numbers.randint(4, 10), numbers.randint(10, 29)
    n = plain + binaries
    factor = [[numbers.gauss(0.0, 1.0) for _ in range(n)] for _ in range(n)]
    for j in range(n):
        limits = (-10.0, 10.0) if j < plain else (0.0, 1.0)
        program.column(*limits, 3.0 * numbers.gauss(0.0, 1.0), j >= plain)
    for i in range(n):
        for j in range(i + 1):
            product = sum(a * b for a, b in zip(factor[i], factor[j])) / n
            program.squares[i, j] = product + (0.1 if i == j else 0.0)
    for _ in range(rows):
        terms = [(j, numbers.gauss(0.0, 1.0)) for j in range(n)]
        program.row(terms, "L", 2.0 * abs(numbers.gauss(0.0, 1.0)))
    return program


def loop(numbers):
    program = Program()
    states, steps, binaries = numbers.randint(2, 6), numbers.randint(3, 8), numbers.randint(2, 8)
    flow = [
        [numbers.gauss(0.0, 0.2) + (0.8 if i == k else 0.0) for k in range(states)]
        for i in range(states)
    ]
    force = [numbers.gauss(0.0, 0.5) for _ in range(states)]
    push = [numbers.gauss(0.0, 1.0) for _ in range(states)]
    # A state is a value for every column that it depends on; None is the constant part.
    state = [{None: numbers.uniform(-2.0, 2.0)} for _ in range(states)]
    costs, left = {}, binaries
    for t in range(steps):
        u = program.column(-1.0, 1.0)
        program.squares[u, u] = 0.2
        # The binaries are spread over the steps, the earliest ones first.
        here = -(-left // (steps - t))
        left -= here
        modes = [program.column(0.0, 1.0, 0.05, True) for _ in range(here)]
        for mode in modes:
            program.squares[mode, mode] = 0.02
        after = []
        for i in range(states):
            own = {u: force[i]}
            own.update((mode, push[i] / (1 + m)) for m, mode in enumerate(modes))
            for k in range(states):
                for j, value in state[k].items():
                    own[j] = own.get(j, 0.0) + flow[i][k] * value
            after.append(own)
        for mode in modes:
            # Without the push, the first state does not fall by more than a tenth.
            fall = {j: value - after[0].get(j, 0.0) for j, value in state[0].items()}
            fall.update((j, -value) for j, value in after[0].items() if j not in fall)
            limit = 0.1 - fall.pop(None, 0.0)
            fall[mode] = fall.get(mode, 0.0) - 20.0
            program.row(fall.items(), "L", limit)
        state = after
        for own in state:
            constant = own.get(None, 0.0)
            terms = [(j, value) for j, value in own.items() if j is not None]
            for j, value in terms:
                costs[j] = costs.get(j, 0.0) + 2.0 * constant * value
                for i, other in terms:
                    if i >= j:
                        program.squares[i, j] = program.squares.get((i, j), 0.0) + 2.0 * value * other
    for j, (lower, upper, cost, whole) in enumerate(program.columns):
        program.columns[j] = (lower, upper, cost + costs.get(j, 0.0), whole)
    return program


def main():
    folder = sys.argv[1]
    seed, count = (int(word) for word in (sys.argv[2:4] + ["1", "24"][len(sys.argv[2:4]) :]))
    for name, build in [("dense", dense), ("loops", loop)]:
        numbers = random.Random(f"{name} {seed}")
        os.makedirs(f"{folder}/{name}", exist_ok=True)
        for k in range(count):
            build(numbers).write(f"{folder}/{name}/{name}_{seed}_{k:02}.mps")


if __name__ == "__main__":
    main()
