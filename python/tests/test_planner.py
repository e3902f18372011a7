"""The planner's door: systems, programs, missions, controllers and scenes, beside numbers that are known otherwise."""

import math
import xml.dom.minidom

import carom
import numpy as np
import pytest


def lift(scale=1.0):
    """The lift with two gears, in other units of length."""
    system = carom.HybridSystem(0.1)
    x = system.state("x", 0, 15 * scale)
    v = system.state("v", -2.5 * scale, 2.5 * scale)
    u = system.input("u", -1, 1)
    system.mode("low gear").rates({x: v, v: 0.6 * scale * u})
    system.mode("high gear").rates({x: v, v: 1.5 * scale * u}).guard(v >= 0.4 * scale)
    return system, x, v, u


def cart():
    """A cart whose input is its speed."""
    system = carom.HybridSystem(1.0)
    x = system.state("x", -20, 20)
    u = system.input("u", -2, 2)
    system.mode("roll").next({x: x + u})
    return system, x, u


def test_shortest_plan_of_the_lift():
    system, x, v, u = lift()
    found = system.shortest([x == 0, v == 0], [x == 12, v == 0])
    assert found.steps == 72 and found.refuted_steps == 71
    assert "72 steps" in str(found)
    plan = found.plan
    assert plan[x].shape == (73,) and plan[u].shape == (72,) and plan.time[-1] == pytest.approx(7.2)
    # Replayed here: exact integration of a held input.
    for k in range(72):
        a = {"low gear": 0.6, "high gear": 1.5}[plan.modes()[k]] * plan[u][k]
        assert plan[x][k + 1] == pytest.approx(plan[x][k] + 0.1 * plan[v][k] + 0.005 * a, abs=1e-6)
        assert plan[v][k + 1] == pytest.approx(plan[v][k] + 0.1 * a, abs=1e-6)
        assert plan.modes()[k] == "low gear" or plan[v][k] >= 0.4 - 1e-6
    assert plan[x][-1] == pytest.approx(12, abs=1e-6)
    assert set(plan.states) == {"x", "v"} and set(plan.inputs) == {"u"}


def test_units_change_nothing():
    system, x, v, _ = lift(1000.0)
    assert system.shortest([x == 0, v == 0], [x == 12000, v == 0]).steps == 72


def test_reasons():
    system, x, v, _ = lift()
    found = system.shortest([x == 0, v == 0], [x == 12, v == 0], max_steps=20)
    assert found.steps is None and found.plan is None
    assert "20 steps" in found.explain(20)
    program = system.program(20)
    program.start([x == 0, v == 0])
    program.goal([x == 12, v == 0])
    with pytest.raises(ValueError, match="without a plan"):
        program.solve()
    assert "cannot hold together" in program.explain()


def test_a_program_with_a_cost():
    """The least effort over 4 steps is the same input in each: 6 m in 4 s, cost 4 x 1.5²."""
    system, x, u = cart()
    program = system.program(4)
    program.start(x == 0)
    program.goal([x == 6])
    program.minimize(program.sum(u**2))
    plan = program.solve(gap=0.0)
    assert plan.is_optimal and plan.objective == pytest.approx(4 * 1.5**2, abs=1e-5)
    assert plan[u] == pytest.approx(np.full(4, 1.5), abs=1e-3)
    assert plan.bound <= plan.objective + 1e-9
    assert plan.value(2 * x + 1, 4) == pytest.approx(13, abs=1e-5)
    assert "x" in plan.csv() and plan.csv().count("\n") >= 6
    assert "ROWS" in program.mps()


def test_requirements_and_magnitudes():
    system, x, u = cart()
    program = system.program(6)
    program.start(x == 0)
    program.require("out", x >= 3, once_in=(2, 4))
    program.require("near", x.within(-5, 3.5), throughout=(0, 6))
    program.require("home", x == 0, at=6)
    program.minimize(program.sum_abs("way", u) + 0.0 * program.end(x))
    plan = program.solve()
    assert plan.objective == pytest.approx(6, abs=1e-6)
    assert max(plan[x][2:5]) >= 3 - 1e-6 and max(plan[x]) <= 3.5 + 1e-6
    with pytest.raises(TypeError, match="one of"):
        program.require("nothing", x >= 0)


def test_a_mission():
    system, x, u = cart()
    program = system.program(8)
    program.start(x == 0)
    mission = carom.Mission("F[0,8] A & G !pond", {"A": [x >= 6], "pond": x.within(2.5, 3.4)})
    program.require_mission(mission)
    program.minimize(program.sum(u**2))
    plan = program.solve()
    assert max(plan[x]) >= 6 - 1e-6
    assert not any(2.5 + 1e-6 < value < 3.4 - 1e-6 for value in plan[x])
    assert plan.robustness(mission) >= -1e-6


def test_modes_with_memory():
    """An engine that starts once pays once."""
    system = carom.HybridSystem(1.0)
    level = system.state("level", 0, 10)
    power = system.input("power", 0, 4)
    system.next({level: level + power - 1.0})
    fuel = system.output("fuel")
    off, on = system.modes("engine", ["off", "on"])
    system.stay(off).guard(power <= 0)
    system.stay(on).output(fuel, power)
    started = system.switch(off, on).output(fuel, power + 3).taken()
    system.switch(on, off).guard(power <= 0)
    system.dwell(on, 2)
    program = system.program(6)
    program.start([level == 3, off == 1])
    program.goal(level >= 3)
    program.minimize(program.sum(fuel))
    plan = program.solve()
    assert plan.objective == pytest.approx(9, abs=1e-5)
    assert sum(plan[started] > 0.5) == 1
    modes = plan.modes("engine")
    assert modes[0] == "off" and len(modes) == 7 and modes.count("on") >= 2


def test_an_event_resets():
    ball = carom.HybridSystem(0.1)
    h, v = ball.state("height", 0, 5), ball.state("speed", -10, 10)
    ball.rates({h: v, v: -9.81})
    ball.mode("fall").guard(h.predicted() >= 0)
    ball.event("bounce").guard(h.predicted() <= 0).guard(v.predicted() <= 0).reset(
        {h: -0.5 * h.predicted(), v: -0.5 * v.predicted()}
    )
    program = ball.program(10)
    program.start([h == 1, v == 0])
    program.maximize(program.end(h))
    assert program.solve().transitions().count("bounce") == 1


def test_norms_and_squares():
    robot = carom.HybridSystem(1.0)
    x, y = robot.state("x", -9, 9), robot.state("y", -9, 9)
    u, w = robot.input("u", -2, 2), robot.input("w", -2, 2)
    robot.mode("go").next({x: x + u, y: y + w})
    robot.limit("speed", carom.norm([u, w]) <= 1)
    program = robot.program(3)
    program.start([x == 0, y == 0])
    program.require("disc", (x - 1) ** 2 + y**2 <= 4, at=3)
    program.maximize(program.end(x + y))
    plan = program.solve()
    assert plan.objective == pytest.approx(1 + 2 * math.sqrt(2), abs=1e-4)


def test_a_controller():
    system, x, u = cart()
    program = system.program(5)
    program.minimize(program.sum((x - 2) ** 2 + 0.1 * u**2))
    controller = carom.RecedingHorizon(program)
    state = np.array([8.0])
    for k in range(6):
        move = controller.step(state)
        assert move.step == k and move.input.shape == (1,) and move.states.shape == (6, 1)
        assert move.transitions["mode"][0] == "roll"
        state = state + move.input
    assert state[0] == pytest.approx(2, abs=0.1)
    with pytest.raises(ValueError):
        controller.step([1.0, 2.0])
    assert controller.step(state).source == "optimal"


def test_a_controller_with_an_integer_horizon():
    room = carom.HybridSystem(600)
    t = room.state("t", 5, 30)
    room.mode("off", choice="heater").next({t: t - 0.5})
    room.mode("on", choice="heater").next({t: t + 0.75})
    program = room.program(10)
    program.minimize(program.sum((t - 20) ** 2))
    whole = carom.RecedingHorizon(program).step([18.0])
    move = carom.RecedingHorizon(program, integer_horizon=2).step([18.0])
    assert (move.source, move.objective, move.states.shape) == ("integer horizon", None, (3, 1))
    assert move.transitions["heater"][0] == "on" and move.bound <= whole.objective + 1e-6
    # The program itself still decides all its steps.
    assert carom.RecedingHorizon(program).step([18.0]).source == "optimal"
    with pytest.raises(ValueError, match="integer horizon"):
        carom.RecedingHorizon(program, integer_horizon=11)


def gusty_cart():
    system = carom.HybridSystem(1)
    x = system.state("x", 0, 9)
    u = system.input("u", -1, 1)
    system.disturbance(x, -0.2, 0.2)
    system.mode("roll").next({x: x + u})
    return system, x, u


def test_a_robust_plan():
    system, x, u = gusty_cart()
    nominal = system.shortest([x == 0], [x.within(2.6, 3.2)])
    found = system.shortest([x == 0], [x.within(2.6, 3.2)], robust=True)
    assert nominal.steps == 3 and nominal.plan.tube is None
    # The feedback takes a part of each input.
    assert found.steps == 4 and found.refuted_steps == 3
    tube = found.plan.tube["x"]
    assert tube.shape == (5, 2) and 2.6 - 1e-6 <= tube[-1, 0] and tube[-1, 1] <= 3.2 + 1e-6
    runs = [found.plan.fly(seed) for seed in range(100)]
    for states, kept in runs:
        assert kept and (states["x"] >= tube[:, 0] - 1e-9).all() and (states["x"] <= tube[:, 1] + 1e-9).all()
    assert (runs[0][0]["x"] != runs[1][0]["x"]).any()
    with pytest.raises(ValueError, match="robust"):
        nominal.plan.fly()
    program = system.program(4)
    program.start([x == 0])
    program.goal([x.within(2.6, 3.2)])
    program.minimize(program.sum(u**2))
    robust, careless = program.solve(robust=True), program.solve()
    assert robust.objective >= careless.objective - 1e-9 and robust.tube["x"].shape == (5, 2)


def test_the_shortest_plan_with_a_mission():
    system, x, u = cart()
    there = carom.Mission("F in A", {"in A": [x >= 6]})
    start, goal = [x == 2], [x == 2]
    found = system.shortest(start, goal, mission=there)
    assert found.steps == 4 and found.plan[x].max() >= 6 - 1e-6
    assert found.plan.robustness(there) >= -1e-6


def test_the_paper_in_a_scene():
    """arXiv 1611.07608: 2.55 s without collisions, 2.245 s with a nearly plastic wall."""
    steps = {}
    for name, restitution in [("free", None), ("tolerant", 0.025)]:
        scene = carom.Scene(0.005)
        scene.body("vehicle", [(-1, 20)], 15, 6, start=[10, 0], goal=[0.3, 0], first_acceleration=[0])
        scene.polytope("wall", [([1.0], 0.0)], restitution=restitution)
        steps[name] = scene.shortest().steps
    assert steps == {"free": 510, "tolerant": 449}


def test_a_scene_in_the_plane():
    scene = carom.Scene(0.25)
    scene.body("robot", [(0, 8), (0, 5)], 2, 1, start=[1, 1, 0, 0], goal=[7, 1, 0, 0])
    scene.room("wall", [(0, 8), (0, 5)]).cuboid("rack", [(3, 5), (-1, 3)])
    found = scene.shortest()
    assert found.steps == 24 and found.refuted_steps == 23 and "24 steps" in str(found)
    path = found.paths["robot"]
    assert path.position.shape == (25, 2) and path.acceleration.shape == (24, 2)
    assert not any(3 < x < 5 and y < 3 - 1e-6 for x, y in path.position)
    xml.dom.minidom.parseString(found.svg())
    assert found.hits == []


def test_pictures():
    system, x, v, _ = lift()
    found = system.shortest([x == 0, v == 0], [x == 3, v == 0])
    for svg in (found.svg(), found.plan.svg("lift"), found._repr_svg_(), found.plan._repr_svg_()):
        xml.dom.minidom.parseString(svg)
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = found.plan.plot()
    assert [axis.get_ylabel() for axis in axes] == ["x", "v", "u"]


@pytest.mark.parametrize("wrong, error, text", [
    (lambda x, v: x < v, TypeError, "closed"),
    (lambda x, v: 0 <= x <= 1, TypeError, "within"),
    (lambda x, v: x * v * v, ValueError, "more than two"),
    (lambda x, v: x**3, ValueError, "only squares"),
    (lambda x, v: x / 0, ValueError, "divided by 0"),
    (lambda x, v: x + "1", TypeError, "unsupported"),
    (lambda x, v: (x + v).predicted(), TypeError, "handle"),
    (lambda x, v: bool(x), TypeError, "truth"),
])
def test_wrong_expressions(wrong, error, text):
    _, x, v, _ = lift()
    with pytest.raises(error, match=text):
        wrong(x, v)


def test_wrong_systems():
    system, x, v, u = lift()
    with pytest.raises(ValueError, match="x"):
        system.state("x", 0, 1)
    with pytest.raises(ValueError, match="second flow"):
        system.mode("twice").next({x: x}).next({x: x})
    with pytest.raises(TypeError, match="dict"):
        system.rates([(x, v)])
    with pytest.raises(ValueError):
        carom.HybridSystem(0.1).program(3)
    _, y, _, _ = lift()
    program = carom.HybridSystem(0.1)
    z = program.state("z", 0, 1)
    with pytest.raises(ValueError):
        program.mode("go").next({z: y})
    with pytest.raises(TypeError, match="rows"):
        lift()[0].program(3).start([True])
    with pytest.raises(TypeError, match="not of plans"):
        system.shortest([x == 0], [x == 1], verbose=True)
    with pytest.raises(TypeError, match="no option"):
        system.shortest([x == 0], [x == 1], limit=3)
    with pytest.raises(ValueError):
        system.shortest([x == 99], [x == 1])


def test_expressions_are_keys():
    _, x, v, u = lift()
    named = {x: "x", v: "v", u: "u"}
    assert [named[handle] for handle in (x, v, u)] == ["x", "v", "u"]
    assert repr(x) == "x" and len({hash(x), hash(v), hash(u)}) == 3
