"""The pendulum and the car of the examples `pendulum` and `parking`, planned by a local method.

    python benches/local_planners.py

For each number of steps, Ipopt starts from ten random guesses; a guess counts if Ipopt says that it has found a
point. The least number of steps with a plan is what a planner by a local method would call shortest; it proves
nothing about smaller ones. Gears of the car are a quadratic limit on the curvature, and the choice between lane and
bay is a product that must vanish, because a local method has no modes. Needs casadi and numpy.
"""
import math
import time

import casadi
import numpy as np

GUESSES = 10


def solve(build, steps, seed):
    """Whether Ipopt finds a point from a random guess."""
    variables, lower, upper, rows, low, high = build(steps)
    problem = {"x": casadi.vertcat(*variables), "f": 0, "g": casadi.vertcat(*rows)}
    options = {"ipopt.print_level": 0, "print_time": 0, "ipopt.sb": "yes", "ipopt.max_iter": 1000}
    solver = casadi.nlpsol("planner", "ipopt", problem, options)
    guess = np.random.default_rng(seed).uniform(lower, upper)
    solver(x0=guess, lbx=lower, ubx=upper, lbg=low, ubg=high)
    return solver.stats()["success"]


class Program:
    def __init__(self):
        self.variables, self.lower, self.upper = [], [], []
        self.rows, self.low, self.high = [], [], []

    def variable(self, lower, upper):
        self.variables.append(casadi.SX.sym(f"x{len(self.variables)}"))
        self.lower.append(lower)
        self.upper.append(upper)
        return self.variables[-1]

    def row(self, value, low, high):
        self.rows.append(value)
        self.low.append(low)
        self.high.append(high)

    def parts(self):
        return self.variables, self.lower, self.upper, self.rows, self.low, self.high


def pendulum(steps):
    step, motor, wall = 0.15, 5.5, 0.85 * math.pi
    program = Program()
    ends = {0: (0.0, 0.0), steps: (wall, 0.0)}
    angles, rates = [], []
    for t in range(steps + 1):
        at = ends.get(t)
        angles.append(program.variable(*((at[0],) * 2 if at else (-math.pi, wall))))
        rates.append(program.variable(*((at[1],) * 2 if at else (-8.0, 8.0))))
    for t in range(steps):
        torque = program.variable(-motor, motor)
        middle = 0.5 * (angles[t] + angles[t + 1])
        program.row(angles[t + 1] - angles[t] - step * 0.5 * (rates[t] + rates[t + 1]), 0, 0)
        turned = step * (torque - 9.81 * casadi.sin(middle))
        program.row(rates[t + 1] - rates[t] - turned, 0, 0)
    return program.parts()


def car(steps):
    step, fastest, steering = 0.5, 1.5, 0.8
    program = Program()
    ends = {0: (2.5, 2.0, 0.0), steps: (0.0, 0.4, 0.0)}
    ranges = [(-4.0, 4.0), (0.0, 3.0), (-1.2, 1.2)]
    states = []
    for t in range(steps + 1):
        at = ends.get(t)
        states.append([
            program.variable(*((at[i],) * 2 if at else ranges[i])) for i in range(3)
        ])
    for t in range(steps):
        speed = program.variable(-fastest, fastest)
        turn = program.variable(-fastest * steering, fastest * steering)
        (x, y, heading), (x1, y1, heading1) = states[t], states[t + 1]
        middle = 0.5 * (heading + heading1)
        program.row(x1 - x - step * speed * casadi.cos(middle), 0, 0)
        program.row(y1 - y - step * speed * casadi.sin(middle), 0, 0)
        program.row(heading1 - heading - step * turn, 0, 0)
        program.row(turn**2 - (steering * speed)**2, -math.inf, 0)
        out_of_lane, out_of_bay = program.variable(0, 1.2), program.variable(0, 3.3)
        for y_of in (y, y1):
            program.row(y_of + out_of_lane, 1.2, math.inf)
        for x_of in (x, x1):
            program.row(x_of - out_of_bay, -math.inf, 0.7)
            program.row(x_of + out_of_bay, -0.7, math.inf)
        program.row(out_of_lane * out_of_bay, -math.inf, 1e-6)
    return program.parts()


def main():
    for name, build, proved in [("pendulum", pendulum, 14), ("car", car, 6)]:
        print(f"{name}: {proved} steps are the least, by proof")
        for steps in range(proved - 1, proved + 5):
            began = time.perf_counter()
            found = [solve(build, steps, seed) for seed in range(GUESSES)]
            seconds = time.perf_counter() - began
            print(f"  {steps} steps: {sum(found)} of {GUESSES} guesses find a plan ({seconds:.1f} s)")


if __name__ == "__main__":
    main()
