"""Hybrid systems, their programs and plans, missions, controllers and scenes, in the words of the Rust crate.

Lengths, speeds and all other values are in units of your choice, times in seconds. A *step* lasts `time_step`; a
plan of N steps has N + 1 samples, at which states have values, and N inputs, each held for a step.
"""

from __future__ import annotations

from typing import Any, Iterable, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np

from . import _carom
from ._arrays import numbers
from ._carom import Expression, Row, norm
from ._settings import settings as _settings

__all__ = [
    "ControlMove", "Expression", "HybridPlan", "HybridProgram", "HybridSystem", "Mission", "RecedingHorizon", "Row",
    "Scene", "ShortestHorizon", "ShortestInScene", "Transition", "norm",
]

MODE = "mode"
"""The choice that `mode` and `event` add to if no other one is named."""

Value = Union[Expression, float]
"""An expression of handles, or a number."""


def settings(options: "dict[str, Any]") -> "dict[str, Any]":
    """The settings of a solve, of which a planner has no use for some."""
    for name in ("callback", "start", "verbose"):
        if name in options:
            raise TypeError(f"`{name}` is an option of `carom.solve`, and not of plans")
    return _settings(options, 0)


def _pairs(entries: Mapping[Expression, Value]) -> "list[tuple[Expression, Value]]":
    """The entries of a flow or a reset."""
    if not isinstance(entries, Mapping):
        raise TypeError(f"a dict {{state: expression}} is needed, not {type(entries).__name__}")
    return list(entries.items())


def _rows(given: Union[Row, Iterable[Row]]) -> "list[Row]":
    """One row or several."""
    rows = [given] if isinstance(given, Row) else list(given)
    for row in rows:
        if not isinstance(row, Row):
            raise TypeError(f"rows are comparisons of handles, such as `x == 0`, not {row!r}")
    return rows


def _values(name: str, given: Any) -> "list[float]":
    """A number, or one for each step."""
    array = np.atleast_1d(numbers(name, given))
    if array.ndim != 1:
        raise ValueError(f"`{name}` has the shape {array.shape} and must be a number, or one for each step")
    return array.tolist()


def _ranges(name: str, given: Any) -> "list[tuple[float, float]]":
    """Pairs of lower and upper ends; a number is both."""
    pairs = [np.atleast_1d(numbers(name, entry)).tolist() for entry in given]
    if any(len(pair) not in (1, 2) for pair in pairs):
        raise ValueError(f"each entry of `{name}` must be a number or a pair (lower, upper)")
    return [(pair[0], pair[-1]) for pair in pairs]


class Transition:
    """A transition that is being stated: a mode in which a step can be spent, an event, or a switch of modes.

    A step in it begins where its guards hold, follows its flow, ends where the guards on predictions hold, and is then
    reset. Each method returns the transition, so that calls can be chained.
    """

    __slots__ = ("_own",)

    def __init__(self, own: "_carom.Transition") -> None:
        self._own = own

    def rates(self, rates: Mapping[Expression, Value]) -> "Transition":
        """States the flow by the derivatives of states (state's unit per second), integrated exactly over a step. States
        that are not named follow the system's common flow, or rest."""
        self._own.rates(_pairs(rates))
        return self

    def next(self, values: Mapping[Expression, Value]) -> "Transition":
        """States the flow by the values of states at the next sample."""
        self._own.next(_pairs(values))
        return self

    def reset(self, values: Mapping[Expression, Value]) -> "Transition":
        """Sets states at the end of the step to expressions of predictions, `x.predicted()`, states and inputs."""
        self._own.reset(_pairs(values))
        return self

    def guard(self, row: Row) -> "Transition":
        """A row that must hold for the step to be in this transition: at its start, or at its end for predictions."""
        self._own.guard(row)
        return self

    def invariant(self, row: Row) -> "Transition":
        """A row that holds at both ends of each step in this transition."""
        self._own.invariant(row)
        return self

    def limit(self, name: str, row: Row) -> "Transition":
        """A guard with a name, by which reasons name it and by which it can be softened."""
        self._own.limit(name, row)
        return self

    def output(self, output: Expression, value: Value) -> "Transition":
        """The value of an output in the steps that take this transition; 0 in those that state none."""
        self._own.output(output, value)
        return self

    def named(self, name: str) -> "Transition":
        """Sets another name, for tables and reports."""
        self._own.named(name)
        return self

    def taken(self) -> Expression:
        """The handle of the transition: 1 in the steps that take it, 0 in the others."""
        return self._own.taken()


class HybridSystem:
    """A system whose dynamics switch: states, inputs, and modes in which its steps are spent.

    >>> lift = HybridSystem(0.1)
    >>> x, v = lift.state("x", 0, 15), lift.state("v", -2.5, 2.5)
    >>> u = lift.input("u", -1, 1)
    >>> _ = lift.mode("low gear").rates({x: v, v: 0.6 * u})
    >>> _ = lift.mode("high gear").rates({x: v, v: 1.5 * u}).guard(v >= 0.4)
    >>> lift.shortest([x == 0, v == 0], [x == 12, v == 0]).steps
    72
    """

    __slots__ = ("_own",)

    def __init__(self, time_step: float) -> None:
        """A system whose steps last `time_step` seconds."""
        self._own = _carom.HybridSystem(time_step)

    @property
    def time_step(self) -> float:
        """The length of a step in s."""
        return self._own.time_step

    def state(self, name: str, lower: float, upper: float) -> Expression:
        """A state with the range that it never leaves, in its unit."""
        return self._own.state(name, lower, upper)

    def input(self, name: str, lower: Any, upper: Any) -> Expression:
        """An input with its range: numbers, or arrays with one for each step, of which the last one stays."""
        return self._own.input(name, _values("lower", lower), _values("upper", upper))

    def series(self, name: str, values: Any) -> Expression:
        """Numbers that are known for each step, such as prices or a forecast; shape (steps,), the last one stays."""
        return self._own.series(name, _values("values", values))

    def output(self, name: str) -> Expression:
        """A quantity that transitions state in each step, such as fuel or damage."""
        return self._own.output(name)

    def rates(self, rates: Mapping[Expression, Value]) -> None:
        """The common flow of all modes, by derivatives; see `Transition.rates`."""
        self._own.rates(_pairs(rates))

    def next(self, values: Mapping[Expression, Value]) -> None:
        """The common flow of all modes, by values at the next sample."""
        self._own.next(_pairs(values))

    def limit(self, name: str, row: Row) -> None:
        """A row that holds in each step, with a name by which reasons name it."""
        self._own.limit(name, row)

    def invariant(self, row: Row) -> None:
        """A row that holds in each step and is not questioned by reasons."""
        self._own.invariant(row)

    def disturbance(self, state: Expression, lower: float, upper: float) -> None:
        """A range, in the state's unit, of what disturbs a state in each step. Plans are nominal: they leave it out."""
        self._own.disturbance(state, lower, upper)

    def most_events(self, most: int) -> None:
        """The largest number of events over the horizon."""
        self._own.most_events(most)

    def mode(self, name: str, choice: str = MODE) -> Transition:
        """A mode without memory: each step takes one of a choice's modes and events whose guards hold."""
        return Transition(self._own.mode(choice, name))

    def event(self, name: str, choice: str = MODE) -> Transition:
        """A mode that counts as an event, such as an impact."""
        return Transition(self._own.event(choice, name))

    def modes(self, choice: str, names: Sequence[str]) -> "list[Expression]":
        """Modes with memory, which last until a switch: handles that are 1 at the samples in the mode, 0 at others."""
        return self._own.modes(choice, list(names))

    def stay(self, mode: Expression) -> Transition:
        """What a step is like that stays in a mode."""
        return Transition(self._own.stay(mode))

    def switch(self, from_mode: Expression, to_mode: Expression) -> Transition:
        """A switch from a mode to another one, which counts as an event."""
        return Transition(self._own.switch(from_mode, to_mode))

    def acting(self, mode: Expression) -> Expression:
        """A handle that is 1 in the steps after which a mode holds, 0 in the others."""
        return self._own.acting(mode)

    def dwell(self, mode: Expression, least: int, most: Optional[int] = None) -> None:
        """How many steps a mode lasts at least, and at most."""
        self._own.dwell(mode, least, most)

    def check(self) -> None:
        """Raises ValueError for a system that is not complete."""
        self._own.check()

    def program(self, steps: int) -> "HybridProgram":
        """The program of the system over some steps."""
        return HybridProgram(self._own.program(steps))

    def shortest(
        self, start: Union[Row, Iterable[Row]], goal: Union[Row, Iterable[Row]], *, mission: "Optional[Mission]" = None,
        robust: bool = False, max_steps: Optional[int] = None, total_time_limit: Optional[float] = None, **options: Any,
    ) -> "ShortestHorizon":
        """The plan with the fewest steps from a start to a goal, with each smaller number refuted.

        With a `mission`, the plan fulfils it. With `robust`, it holds for every `disturbance` of the system: a
        linear-quadratic regulator answers them, and numbers are refuted for plans with this feedback.

        `total_time_limit` (s) is for the whole search; the options of `carom.solve`, such as `threads` or `time_limit`,
        are for each of its solves.
        """
        own = self._own.shortest(
            _rows(start), _rows(goal), None if mission is None else mission._own, robust, max_steps, total_time_limit,
            settings(options),
        )
        return ShortestHorizon(own)


class ShortestHorizon:
    """What a search for the shortest plan has found. `print(found)` says it in a sentence."""

    __slots__ = ("_own",)

    def __init__(self, own: "_carom.Shortest") -> None:
        self._own = own

    @property
    def steps(self) -> Optional[int]:
        """The least number of steps that was found; None without a plan."""
        return self._own.steps

    @property
    def refuted_steps(self) -> Optional[int]:
        """The largest number of steps that is proved impossible together with all smaller ones."""
        return self._own.refuted_steps

    @property
    def plan(self) -> Optional["HybridPlan"]:
        """The plan; None if none was found."""
        plan = self._own.plan
        return None if plan is None else HybridPlan(plan)

    def explain(self, steps: int) -> Optional[str]:
        """Why there is no plan of so many steps, by the sets that can be reached; None if these do not tell."""
        return self._own.explain(steps)

    def svg(self, first: int = 0, second: int = 1, title: str = "") -> Optional[str]:
        """A picture of two states, by number, among the sets that can be reached; None without sets."""
        return self._own.svg(first, second, title)

    def _repr_svg_(self) -> Optional[str]:
        try:
            return self.svg()
        except ValueError:
            return None

    def __str__(self) -> str:
        return str(self._own)

    def __repr__(self) -> str:
        return str(self._own)


class Mission:
    """What is to hold when, in signal temporal logic.

    `Mission("F[0,8] A & G !pond", {"A": [x >= 4], "pond": [x.within(1, 2)]})`: in A at one of the samples 0 to 8, and
    never in the pond. Operators: `!`, `&`, `|`, `->`, `F[a,b]` (eventually), `G[a,b]` (always), `U[a,b]` (until).
    """

    __slots__ = ("_own",)

    def __init__(self, text: str, names: Mapping[str, Union[Row, Iterable[Row]]]) -> None:
        self._own = _carom.Mission(text, [(name, _rows(rows)) for name, rows in names.items()])

    def __str__(self) -> str:
        return str(self._own)


class HybridProgram:
    """A system over a number of steps, with a start, a goal, requirements and a cost."""

    __slots__ = ("_own",)

    def __init__(self, own: "_carom.HybridProgram") -> None:
        self._own = own

    @property
    def steps(self) -> int:
        """The number of steps."""
        return self._own.steps

    def start(self, rows: Union[Row, Iterable[Row]]) -> None:
        """Rows of states and modes at the first sample."""
        self._own.start(_rows(rows))

    def goal(self, rows: Union[Row, Iterable[Row]]) -> None:
        """Rows of states and modes at the last sample."""
        self._own.goal(_rows(rows))

    def require(
        self, name: str, rows: Union[Row, Iterable[Row]], *, at: Optional[int] = None,
        throughout: Optional["tuple[int, int]"] = None, once_in: Optional["tuple[int, int]"] = None,
    ) -> None:
        """Rows at a sample, at all samples from one to another (both included), or at one of these."""
        given = [window for window in (None if at is None else (at, at), throughout, once_in) if window is not None]
        if len(given) != 1:
            raise TypeError("one of `at`, `throughout` and `once_in` is needed")
        self._own.require(name, _rows(rows), given[0][0], given[0][1], once_in is not None)

    def require_mission(self, mission: Mission, name: str = "mission") -> None:
        """A mission over the samples of the program."""
        self._own.require_mission(name, mission._own)

    def sum(self, of: Value) -> Expression:
        """The sum of an expression over all steps; the last sample is not among them, see `end`."""
        return self._own.sum(of)

    def sum_abs(self, name: str, of: Value) -> Expression:
        """The sum of the magnitudes of an expression over all steps, as variables `name[t]`."""
        return self._own.sum_abs(name, of)

    def at(self, of: Value, sample: int) -> Expression:
        """An expression at a sample."""
        return self._own.at(of, sample)

    def end(self, of: Value) -> Expression:
        """An expression at the last sample."""
        return self._own.at(of, self.steps)

    def minimize(self, cost: Value) -> None:
        """The cost, made of `sum`, `sum_abs`, `at` and `end`."""
        self._own.minimize(cost)

    def maximize(self, gain: Value) -> None:
        """The gain, made of `sum`, `sum_abs`, `at` and `end`."""
        self._own.maximize(gain)

    def solve(self, *, robust: bool = False, **options: Any) -> "HybridPlan":
        """The best plan, for every disturbance of the system if it is `robust`; the options are those of `carom.solve`,
        without `callback`, `start` and `verbose`. Raises ValueError if there is none."""
        return HybridPlan(self._own.solve(robust, settings(options)))

    def explain(self, **options: Any) -> str:
        """Which statements cannot hold together, in words."""
        return self._own.explain(settings(options))

    def mps(self) -> str:
        """The program as rows, as the text of an MPS file."""
        return self._own.write()


class HybridPlan:
    """A plan, replayed by code that does not know how it was found. `plan[x]` are the values of a handle."""

    __slots__ = ("_own",)

    def __init__(self, own: "_carom.Plan") -> None:
        self._own = own

    @property
    def steps(self) -> int:
        """The number of steps."""
        return self._own.steps

    @property
    def time(self) -> np.ndarray:
        """The times of the samples in s, shape (steps + 1,)."""
        return self._own.time_step * np.arange(self.steps + 1)

    @property
    def objective(self) -> Optional[float]:
        """Its cost or gain."""
        return self._own.answer()[0]

    @property
    def bound(self) -> float:
        """No plan is better than this, proved."""
        return self._own.answer()[1]

    @property
    def is_optimal(self) -> bool:
        """Whether it is proved that no plan is better, up to the gap that was asked for."""
        return self._own.answer()[2]

    def __getitem__(self, handle: Expression) -> np.ndarray:
        """The values of a state or mode at the samples, shape (steps + 1,), or of an input, a transition or an output in
        the steps, shape (steps,)."""
        return np.frombuffer(self._own.values(handle))

    def value(self, of: Value, sample: int) -> float:
        """The value of an expression of handles at a sample."""
        return self._own.value(of, sample)

    def modes(self, choice: str = MODE) -> "list[str]":
        """The modes of a choice: at each sample of one with memory, in each step of one without."""
        try:
            return self._own.modes(choice)
        except ValueError:
            return self._own.transitions(choice)

    def transitions(self, choice: str = MODE) -> "list[str]":
        """The transition that a choice takes in each step."""
        return self._own.transitions(choice)

    @property
    def states(self) -> "dict[str, np.ndarray]":
        """States by name, each of shape (steps + 1,)."""
        return {name: np.frombuffer(values) for name, values in self._own.table()[0]}

    @property
    def inputs(self) -> "dict[str, np.ndarray]":
        """Inputs by name, each of shape (steps,)."""
        return {name: np.frombuffer(values) for name, values in self._own.table()[1]}

    @property
    def tube(self) -> "Optional[dict[str, np.ndarray]]":
        """Of a robust plan: by state, the ends of its values in every disturbed run, shape (steps + 1, 2), by interval
        simulation. None for a plan that promises nothing under disturbances."""
        tube = self._own.tube()
        return None if tube is None else {name: np.frombuffer(ends).reshape(-1, 2) for name, ends in tube}

    def fly(self, seed: int = 0) -> "tuple[dict[str, np.ndarray], bool]":
        """Of a robust plan: the states of a run through random disturbances, and whether it keeps the plan's modes."""
        flown = self._own.fly(seed)
        if flown is None:
            raise ValueError("this plan is not robust; ask for one by `robust=True`")
        states, kept = flown
        return {name: np.frombuffer(values) for name, values in states}, kept

    def robustness(self, mission: Mission) -> float:
        """By how much the plan fulfils a mission (positive) or misses it (negative), in the unit of its rows."""
        return self._own.robustness(mission._own)

    def csv(self) -> str:
        """A table of comma-separated values with a line for each sample."""
        return self._own.csv()

    def svg(self, title: str = "") -> str:
        """A picture: each state and each input over time."""
        return self._own.svg(title)

    def _repr_svg_(self) -> str:
        return self.svg()

    def plot(self, axes: Any = None) -> Any:
        """Draws states and inputs over time by matplotlib, which has to be installed; returns its axes."""
        import matplotlib.pyplot as plt

        states, inputs = self.states, self.inputs
        if axes is None:
            _, axes = plt.subplots(len(states) + len(inputs), 1, sharex=True, squeeze=False)
            axes = axes[:, 0]
        for axis, (name, values) in zip(axes, states.items()):
            axis.plot(self.time, values)
            axis.set_ylabel(name)
        for axis, (name, values) in zip(axes[len(states):], inputs.items()):
            axis.step(self.time, np.append(values, values[-1]), where="post")
            axis.set_ylabel(name)
        axes[-1].set_xlabel("time (s)")
        return axes


class ControlMove(NamedTuple):
    """What a controller does next."""

    step: int
    """The number of the step, from 0 on."""
    input: np.ndarray
    """The input to apply, an entry for each input."""
    source: str
    """Where it comes from: a plan, the rest of the last one, a fallback."""
    objective: Optional[float]
    """The cost of the plan."""
    bound: Optional[float]
    """No plan costs less, proved."""
    states: np.ndarray
    """The planned states at the samples, shape (steps + 1, states)."""
    inputs: np.ndarray
    """The planned inputs in the steps, shape (steps, inputs)."""
    transitions: "dict[str, list[str]]"
    """By choice, the planned transition of each step."""
    modes: "dict[str, list[str]]"
    """By choice with memory, the planned mode at each sample."""
    nodes: int
    """Nodes of the search."""
    seconds: float
    """How long it took (s)."""


class RecedingHorizon:
    """A controller that solves a program anew in each step, from the measured state, prepared and warm.

    The program has a cost and no start; `budget` (s) is for each step. With an `integer_horizon` of k, modes and listed
    values of inputs are decided in the first k steps only, and are mixtures after them: moves come sooner, their source is
    "integer horizon", they have k planned steps and no objective, and their bound is still one on the cost of every plan.
    """

    __slots__ = ("_own",)

    def __init__(
        self, program: HybridProgram, *, budget: Optional[float] = None, integer_horizon: Optional[int] = None, **options: Any,
    ) -> None:
        self._own = _carom.Controller(program._own, budget, integer_horizon, settings(options))

    def step(self, state: Any) -> ControlMove:
        """The move for a measured state, an entry for each state."""
        told = self._own.step(np.ascontiguousarray(numbers("state", state)).tobytes())
        table = lambda rows: np.array([np.frombuffer(row) for row in rows])
        return ControlMove(**{
            **told, "input": np.frombuffer(told["input"]), "states": table(told["states"]),
            "inputs": table(told["inputs"]), "transitions": dict(told["transitions"]), "modes": dict(told["modes"]),
        })


class ScenePath(NamedTuple):
    """How a body moves."""

    position: np.ndarray
    """In m, shape (steps + 1, axes)."""
    velocity: np.ndarray
    """In m/s, shape (steps + 1, axes)."""
    acceleration: np.ndarray
    """In m/s², shape (steps, axes)."""


class Scene:
    """Bodies that move in a plane or in space, and what they avoid or bounce off. Lengths in m, times in s."""

    __slots__ = ("_own",)

    def __init__(self, time_step: float) -> None:
        self._own = _carom.Scene(time_step)

    def body(
        self, name: str, domain: Any, speed: float, acceleration: float, *, start: Any, goal: Any,
        first_acceleration: Any = None,
    ) -> "Scene":
        """A point of 1 kg: where it may be along each axis (pairs, m), its largest speed (m/s) and acceleration (m/s²)
        along each axis, and where it starts and ends: positions, then velocities, each a number or a pair. The
        acceleration of the first step may be given (m/s², an entry for each axis)."""
        first = None if first_acceleration is None else _values("first_acceleration", first_acceleration)
        self._own.body(
            name, _ranges("domain", domain), speed, acceleration, _ranges("start", start), _ranges("goal", goal), first
        )
        return self

    def room(self, name: str, walls: Any, *, restitution: Optional[float] = None) -> "Scene":
        """A room: a pair for each axis (m). Its walls are avoided, or hit with a restitution from 0 to 1."""
        self._own.room(name, _ranges("walls", walls), restitution)
        return self

    def cuboid(self, name: str, sides: Any, *, restitution: Optional[float] = None) -> "Scene":
        """A box along the axes: a pair for each (m)."""
        self._own.cuboid(name, _ranges("sides", sides), restitution)
        return self

    def polytope(self, name: str, faces: Any, *, restitution: Optional[float] = None) -> "Scene":
        """The points where `normal @ p <= offset` for all faces (normal, offset)."""
        given = [(np.atleast_1d(numbers("normal", normal)).tolist(), float(offset)) for normal, offset in faces]
        self._own.polytope(name, given, restitution)
        return self

    def shortest(
        self, *, max_steps: Optional[int] = None, total_time_limit: Optional[float] = None, **options: Any
    ) -> "ShortestInScene":
        """The plan with the fewest steps, with each smaller number refuted; options as `HybridSystem.shortest`."""
        return ShortestInScene(self._own.shortest(max_steps, total_time_limit, settings(options)))


class ShortestInScene:
    """What a search for the shortest plan of a scene has found."""

    __slots__ = ("_own",)

    def __init__(self, own: "_carom.ShortestInScene") -> None:
        self._own = own

    @property
    def steps(self) -> Optional[int]:
        """The least number of steps that was found; None without a plan."""
        return self._own.steps

    @property
    def refuted_steps(self) -> Optional[int]:
        """The largest number of steps that is proved impossible together with all smaller ones."""
        return self._own.refuted_steps

    @property
    def paths(self) -> "dict[str, ScenePath]":
        """By body, how it moves; empty without a plan."""
        return {
            name: ScenePath(*(np.frombuffer(values).reshape(-1, axes) for values in all_of))
            for name, axes, all_of in self._own.paths()
        }

    @property
    def hits(self) -> "list[tuple[int, str, str]]":
        """Hits: step, contact and body."""
        return self._own.hits()

    def svg(self) -> Optional[str]:
        """A picture of the plan; None without one."""
        return self._own.svg()

    def _repr_svg_(self) -> Optional[str]:
        return self.svg()

    def __str__(self) -> str:
        return str(self._own)

    def __repr__(self) -> str:
        return str(self._own)
