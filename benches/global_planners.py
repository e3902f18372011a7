"""The examples `pendulum`, `parking`, `quadrotor_gap` and `two_link_arm` as programs of SCIP.

    cargo build --release --examples
    python benches/global_planners.py [FOLDER OF EXAMPLES]

SCIP is asked for any plan of the least number of steps, and whether one step less has a plan, on one thread and for
at most two minutes each; modes are binaries with the least big-Ms over the domains. The example does more: it refutes
every smaller horizon, too, and proves how far the motion is from its samples. Seconds are those of the processor.
Needs pyscipopt.
"""
import math
import os
import resource
import subprocess
import sys
import time

from pyscipopt import Model, cos, sin

LIMIT = 120.0
FOLDER = sys.argv[1] if len(sys.argv) > 1 else "target/release/examples"


class Program:
    def __init__(self):
        self.model = Model()
        self.model.hideOutput()
        self.model.setParam("limits/time", LIMIT)
        self.model.setParam("timing/clocktype", 1)

    def variable(self, lower, upper):
        return self.model.addVar(lb=lower, ub=upper)

    def states(self, ranges, start, goal, steps):
        """Variables of all samples; `None` leaves an entry of a start or a goal open."""
        ends = {0: start, steps: goal}
        samples = []
        for t in range(steps + 1):
            at = ends.get(t, [None] * len(ranges))
            samples.append([
                self.variable(*(ranges[i] if at[i] is None else (at[i], at[i]))) for i in range(len(ranges))
            ])
        return samples

    def row(self, value):
        self.model.addCons(value)

    def one_of(self, count):
        binaries = [self.model.addVar(vtype="B") for _ in range(count)]
        self.row(sum(binaries) == 1)
        return binaries

    def if_on(self, binary, value, most):
        """`value <= 0` if a binary is on; `most` is the largest value."""
        self.row(value <= most * (1 - binary))


def pendulum(steps):
    step, motor, wall = 0.15, 5.5, 0.85 * math.pi
    program = Program()
    samples = program.states([(-math.pi, wall), (-8.0, 8.0)], (0.0, 0.0), (wall, 0.0), steps)
    for (angle, rate), (angle1, rate1) in zip(samples, samples[1:]):
        torque = program.variable(-motor, motor)
        program.row(angle1 - angle == step * 0.5 * (rate + rate1))
        program.row(rate1 - rate == step * (torque - 9.81 * sin(0.5 * (angle + angle1))))
    return program


def leaning(steps):
    step, motor, wall, impact = 0.15, 5.5, 0.85 * math.pi, 3.5
    program = Program()
    samples = program.states([(-math.pi, wall), (-8.0, 8.0)], (0.0, 0.0), (wall, 0.0), steps)
    for (angle, rate), (angle1, rate1) in zip(samples, samples[1:]):
        torque = program.variable(-motor, motor)
        swing, lean = program.one_of(2)
        moved = angle1 - angle - step * 0.5 * (rate + rate1)
        turned = rate1 - rate - step * (torque - 9.81 * sin(0.5 * (angle + angle1)))
        for sign in (1.0, -1.0):
            program.if_on(swing, sign * moved, wall + math.pi + step * 8.0)
            program.if_on(swing, sign * turned, 16.0 + step * (motor + 9.81))
        program.if_on(lean, wall - angle - step * rate, wall + math.pi + step * 8.0)
        program.if_on(lean, -rate, 8.0)
        program.if_on(lean, rate - impact, 8.0 - impact)
        program.if_on(lean, wall - angle1, wall + math.pi)
        for sign in (1.0, -1.0):
            program.if_on(lean, sign * rate1, 8.0)
    return program


def parking(steps):
    step, fastest, steering = 0.5, 1.5, 0.8
    program = Program()
    ranges = [(-4.0, 4.0), (0.0, 3.0), (-1.2, 1.2)]
    samples = program.states(ranges, (2.5, 2.0, 0.0), (0.0, 0.4, 0.0), steps)
    for (x, y, heading), (x1, y1, heading1) in zip(samples, samples[1:]):
        speed = program.variable(-fastest, fastest)
        turn = program.variable(-fastest * steering, fastest * steering)
        middle = 0.5 * (heading + heading1)
        program.row(x1 - x == step * speed * cos(middle))
        program.row(y1 - y == step * speed * sin(middle))
        program.row(heading1 - heading == step * turn)
        for gear, ahead in zip(program.one_of(2), (1.0, -1.0)):
            program.if_on(gear, -ahead * speed, fastest)
            program.if_on(gear, turn - ahead * steering * speed, 2.0 * fastest * steering)
            program.if_on(gear, -turn - ahead * steering * speed, 2.0 * fastest * steering)
        lane, bay = program.one_of(2)
        for at, aside in ((x, y), (x1, y1)):
            program.if_on(lane, 1.2 - aside, 1.2)
            program.if_on(bay, at - 0.7, 3.3)
            program.if_on(bay, -0.7 - at, 3.3)
    return program


def quadrotor_gap(steps):
    step = 0.2
    program = Program()
    ranges = [(0.0, 4.0), (0.0, 3.0), (-4.0, 4.0), (-3.0, 3.0), (-0.7, 0.7)]
    rest = [0.0, 0.0, 0.0]
    samples = program.states(ranges, [0.5, 0.8] + rest, [3.5, 0.8] + rest, steps)
    for (x, z, vx, vz, tilt), (x1, z1, vx1, vz1, tilt1) in zip(samples, samples[1:]):
        thrust, turn = program.variable(4.0, 16.0), program.variable(-3.0, 3.0)
        middle = 0.5 * (tilt + tilt1)
        program.row(x1 - x == step * 0.5 * (vx + vx1))
        program.row(z1 - z == step * 0.5 * (vz + vz1))
        program.row(vx1 - vx == step * thrust * sin(middle))
        program.row(vz1 - vz == step * (thrust * cos(middle) - 9.81))
        program.row(tilt1 - tilt == step * turn)
        before, gap, behind = program.one_of(3)
        for along, above in ((x, z), (x1, z1)):
            program.if_on(before, along - 1.8, 2.2)
            program.if_on(gap, 1.5 - above, 1.5)
            program.if_on(gap, above - 1.8, 1.2)
            program.if_on(behind, 2.2 - along, 2.2)
    return program


def two_link_arm(steps):
    source = open(os.path.join(os.path.dirname(__file__), "../examples/two_link_arm.rs")).read()

    def constant(name):
        text = source.split(f"const {name}:", 1)[1].split("=", 1)[1].split(";", 1)[0]
        return eval(text)

    post, goal, margin = constant("POST"), constant("GOAL"), constant("MARGIN")
    program = Program()
    samples = program.states([(-1.0, 2.0), (-2.5, 2.5)], (-0.5, 0.3), (None, None), steps)
    for (shoulder, elbow), (shoulder1, elbow1) in zip(samples, samples[1:]):
        program.row(shoulder1 - shoulder == 0.2 * program.variable(-1.5, 1.5))
        program.row(elbow1 - elbow == 0.2 * program.variable(-2.0, 2.0))
        right, left, before, below = program.one_of(4)
        forearm = [cos(shoulder + elbow), sin(shoulder + elbow)]
        for along in post[0]:
            for above in post[1]:
                beside = above * forearm[0] - along * forearm[1] + sin(elbow)
                most = abs(above) + abs(along) + 1.0 + margin
                program.if_on(right, margin - beside, most)
                program.if_on(left, beside + margin, most)
        program.if_on(before, cos(shoulder) + forearm[0] - post[0][0], 2.0 - post[0][0])
        program.if_on(below, sin(shoulder) + forearm[1] - post[1][0], 2.0 - post[1][0])
    shoulder, elbow = samples[-1]
    for value, (low, high) in ((cos(shoulder) + cos(shoulder + elbow), goal[0]),
                               (sin(shoulder) + sin(shoulder + elbow), goal[1])):
        program.row(value >= low)
        program.row(value <= high)
    return program


def seconds_of(name):
    used = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])
    before = used()
    subprocess.run([os.path.join(FOLDER, name)], check=True, stdout=subprocess.DEVNULL)
    return used() - before


def main():
    logs = []
    for name, programs in (
        ("pendulum", [(pendulum, 14), (leaning, 13)]),
        ("parking", [(parking, 6)]),
        ("quadrotor_gap", [(quadrotor_gap, 8)]),
        ("two_link_arm", [(two_link_arm, 3)]),
    ):
        total, cells = 0.0, []
        for build, least in programs:
            for steps in (least - 1, least):
                program = build(steps)
                began = time.process_time()
                program.model.optimize()
                seconds = time.process_time() - began
                total += seconds
                cells.append(f"{build.__name__} {steps} steps {program.model.getStatus()} {seconds:.2f} s")
        own = seconds_of(name)
        logs.append(math.log(own / total))
        print(f"{name}: SCIP {', '.join(cells)}; the example {own:.2f} s, {own / total:.2f}", flush=True)
    print(f"geometric mean {math.exp(sum(logs) / len(logs)):.2f}")


if __name__ == "__main__":
    main()
