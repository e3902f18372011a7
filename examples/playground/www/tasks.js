// What there is to try: for each kind of task its sliders, what can be dragged, its examples, and the
// task that the planner is given. A state is a flat list of numbers, so that a link can hold it. The sliders
// named `main` come first: on a phone, the others are below a fold.

export const NO_LIMIT = 20;
const STEPS = [0.005, 0.01, 0.02, 0.025, 0.05, 0.1, 0.2, 0.5];

const knob = (key, label, unit, min, max, step, digits, more) => ({ key, label, unit, min, max, step, digits, ...more });
const restitution = label => knob("restitution", label, "", 0, 1, 0.005, 3);
const timeStep = values => ({ key: "timeStep", label: "Time step", unit: "s", values, digits: 3 });
/** A velocity: sliders keep it within the largest speed. */
const speed = { within: "maxSpeed" };
const limit = value => value >= NO_LIMIT ? null : value;

// What can be dragged: a place, of which `x` and `y` are the numbers in the state, or the arrow of a velocity.
// `half` is how far something reaches from its middle: all of it stays in the room.
const POINT = [0, 0];
const body = (name, label, number, half = POINT) => ({ name, label, kind: "body", body: number, half, x: `${name}X`, y: `${name}Y` });
const goalOf = (half = POINT) => ({ name: "goal", label: "Goal", kind: "goal", half, x: "goalX", y: "goalY" });
const place = (name, label, half) => ({ name, label, kind: "place", half, x: `${name}X`, y: `${name}Y` });
const obstacle = (name, label, half) => ({ name, label, kind: "obstacle", half, x: `${name}X`, y: `${name}Y` });
const arrow = (y = "velocityY") => ({ name: "velocity", label: "Velocity", kind: "velocity", of: "start", x: "velocityX", y });

const point = (state, name) => [state[`${name}X`], state[`${name}Y`]];
const millimetres = value => Math.round(1000 * value) / 1000;
const around = ([x, y], [w, h]) => [[x - w, x + w], [y - h, y + h]].map(ends => ends.map(millimetres));

const wall = {
  title: "Hit the wall to be faster",
  short: "A wall",
  intro: "A vehicle must stop at its goal, close to a wall. It may brake in time, or let the wall help. Move a slider:",
  knobs: [
    knob("start", "Start", "m", 0, 15, 0.1, 1),
    knob("velocity", "Velocity at the start", "m/s", -16, 16, 0.5, 1, speed),
    knob("goal", "Goal", "m", 0, 8, 0.05, 2),
    restitution("Restitution of the wall"),
    knob("impactLimit", "Largest impact speed", "m/s", 0, NO_LIMIT, 0.05, 2, { none: "no limit" }),
    knob("maxSpeed", "Largest speed", "m/s", 0.5, 20, 0.5, 1),
    knob("maxAcceleration", "Largest acceleration", "m/s²", 0, 12, 0.25, 2),
    timeStep(STEPS),
  ],
  handles: [
    { name: "start", label: "Start", kind: "body", x: "start" },
    { name: "velocity", label: "Velocity", kind: "velocity", of: "start", x: "velocity" },
    { name: "goal", label: "Goal", kind: "goal", x: "goal" },
  ],
  main: ["restitution", "impactLimit"],
  coarsest: 0.04,
  defaults: { start: 10, velocity: 0, goal: 0.3, restitution: 0, impactLimit: NO_LIMIT, maxSpeed: 15, maxAcceleration: 6, timeStep: 0.005 },
  presets: {
    "Plastic wall": {},
    "The paper’s 2.245 s": { restitution: 0.025 },
    "Bounce": { restitution: 0.5 },
    "Gentle hits": { impactLimit: 6.2 },
    "Saved by the wall": { start: 4, velocity: -10, restitution: 0.3 },
    "No way out": { start: 4, velocity: -10, restitution: 0.3, impactLimit: 4 },
  },
  task: state => ({ ...state, impactLimit: limit(state.impactLimit) }),
};

const velocities = (most, step) => [
  knob("velocityX", "Velocity at the start, to the right", "m/s", -most, most, step, 2, speed),
  knob("velocityY", "Velocity at the start, upward", "m/s", -most, most, step, 2, speed),
];

const bank = {
  title: "Two cushions turn a puck around",
  short: "Two cushions",
  intro: "A puck must come to rest at its goal. It may avoid the cushions, or bank off them. Drag the puck, its goal and the block, or move a slider:",
  room: [[0, 2], [0, 1]],
  knobs: [
    ...velocities(3, 0.1),
    restitution("Restitution of the cushions"),
    knob("maxSpeed", "Largest speed along each axis", "m/s", 0.5, 6, 0.1, 1),
    knob("maxAcceleration", "Largest acceleration along each axis", "m/s²", 0, 6, 0.25, 2),
    timeStep([0.05, 0.1, 0.2, 0.5]),
  ],
  handles: [body("start", "Puck", 0), goalOf(), obstacle("block", "Block", [0.1, 0.1]), arrow()],
  main: ["restitution", "maxAcceleration"],
  arrow: 0.12,
  coarsest: 0.2,
  defaults: { velocityX: 2, velocityY: 2, restitution: 0.9, maxSpeed: 3, maxAcceleration: 3, timeStep: 0.05,
    startX: 1.2, startY: 0.2, goalX: 0.4, goalY: 0.2, blockX: 0.5, blockY: 0.7 },
  presets: {
    "Far corner": {},
    "Dead cushions": { restitution: 0 },
    "Around the block": { velocityX: 0, velocityY: 0, startX: 1.6, startY: 0.5, blockX: 1, blockY: 0.4 },
    "Elastic": { restitution: 1 },
  },
  task: state => ({
    timeStep: state.timeStep, longest: 5, room: bank.room, walls: true, restitution: state.restitution, impulseLimit: null,
    bodies: [{ name: "puck", mass: 1, start: [...point(state, "start"), state.velocityX, state.velocityY],
      goal: [...point(state, "goal"), 0, 0], maxSpeed: state.maxSpeed, maxAcceleration: state.maxAcceleration }],
    obstacles: [{ name: "block", sides: around(point(state, "block"), [0.1, 0.1]) }],
  }),
};

const pillar = {
  title: "A free-flyer gets around a pillar",
  short: "A pillar",
  intro: "A robot of 10 kg drifts in a room, and must stop at its goal. It may avoid the walls, or push itself off. Drag the robot, its goal and the pillar, or move a slider:",
  room: [[0, 4], [0, 3]],
  knobs: [
    ...velocities(0.5, 0.025),
    restitution("Restitution of the walls"),
    knob("impulseLimit", "Largest impulse", "N s", 0, NO_LIMIT, 0.5, 1, { none: "no limit" }),
    knob("maxSpeed", "Largest speed", "m/s", 0.1, 1, 0.05, 2),
    knob("maxAcceleration", "Largest acceleration", "m/s²", 0, 0.5, 0.025, 3),
    { key: "isRound", label: "These two hold", values: [0, 1], names: ["along each axis", "in every direction"] },
    timeStep([0.5, 1, 2]),
  ],
  handles: [body("start", "Robot", 0, [0.16, 0.16]), goalOf([0.16, 0.16]), obstacle("pillar", "Pillar", [0.3, 0.65]), arrow()],
  main: ["restitution", "impulseLimit"],
  arrow: 1.5,
  coarsest: 2,
  defaults: { velocityX: -0.4, velocityY: 0.3, restitution: 0.6, impulseLimit: NO_LIMIT, maxSpeed: 0.5, maxAcceleration: 0.15, isRound: 0, timeStep: 0.5,
    startX: 0.8, startY: 1.5, goalX: 3.5, goalY: 1.2, pillarX: 2, pillarY: 1.55 },
  presets: {
    "Behind the pillar": {},
    "Soft bumpers": { impulseLimit: 6 },
    "One thruster": { isRound: 1 },
    "At rest": { velocityX: 0, velocityY: 0 },
    "Too fast to stop": { velocityX: -0.5, velocityY: 0, startX: 0.6, restitution: 0.3 },
  },
  task: state => ({
    timeStep: state.timeStep, longest: 30, room: pillar.room, walls: true, restitution: state.restitution, impulseLimit: limit(state.impulseLimit),
    bodies: [{ name: "robot", mass: 10, radius: 0.16, start: [...point(state, "start"), state.velocityX, state.velocityY],
      goal: [...point(state, "goal"), 0, 0], maxSpeed: state.maxSpeed, maxAcceleration: state.maxAcceleration,
      isRound: state.isRound === 1 }],
    obstacles: [{ name: "pillar", sides: around(point(state, "pillar"), [0.3, 0.65]) }],
  }),
};

const exchange = {
  title: "Two vehicles exchange momentum",
  short: "Two vehicles",
  intro: "A carrier of 2 kg arrives too fast to stop at its goal, and a cart stands in its way. It may avoid the cart, or brake against it. Drag both and the goal, or move a slider:",
  room: [[0, 6], [0, 1.4]],
  knobs: [
    knob("velocityX", "Velocity of the carrier", "m/s", -3, 3, 0.1, 1, speed),
    restitution("Restitution of the bumpers"),
    knob("impulseLimit", "Largest impulse", "N s", 0, NO_LIMIT, 0.25, 2, { none: "no limit" }),
    knob("mass", "Mass of the cart", "kg", 0.2, 5, 0.1, 1),
    knob("maxSpeed", "Largest speed along each axis", "m/s", 0.5, 4, 0.1, 1),
    knob("maxAcceleration", "Largest acceleration along each axis", "m/s²", 0, 2, 0.1, 1),
    timeStep([0.25, 0.5]),
  ],
  handles: [body("start", "Carrier", 0, [0.3, 0.2]), body("cart", "Cart", 1, [0.2, 0.2]), goalOf([0.3, 0.2]), arrow(null)],
  main: ["restitution", "mass"],
  arrow: 0.25,
  coarsest: 0.5,
  defaults: { velocityX: 2, restitution: 0.8, impulseLimit: 4, mass: 1, maxSpeed: 3, maxAcceleration: 1, timeStep: 0.25,
    startX: 0.5, startY: 0.7, cartX: 2.2, cartY: 0.7, goalX: 2, goalY: 0.7 },
  presets: {
    "Brake against the cart": {},
    "A heavy cart": { mass: 3 },
    "Fragile": { impulseLimit: 1 },
    "No way around": { cartX: 1.5, cartY: 0.4 },
  },
  task: state => ({
    timeStep: state.timeStep, longest: 10, room: exchange.room, walls: false, restitution: state.restitution, impulseLimit: limit(state.impulseLimit),
    bodies: [
      { name: "carrier", mass: 2, half: [0.3, 0.2], start: [...point(state, "start"), state.velocityX, 0], goal: [...point(state, "goal"), 0, 0],
        maxSpeed: state.maxSpeed, maxAcceleration: state.maxAcceleration },
      { name: "cart", mass: state.mass, half: [0.2, 0.2], start: [...point(state, "cart"), 0, 0], goal: null,
        maxSpeed: state.maxSpeed, maxAcceleration: state.maxAcceleration },
    ],
    obstacles: [],
  }),
};

/** What a robot has to do, and the formula of signal temporal logic that says so. */
const MISSIONS = [
  ["see A, B and C, and never D", "F in A & F in B & F in C & G !in D"],
  ["see A, and B after it, and never D", "F (in A & F in B) & G !in D"],
  ["see A within 6 s, and B, and never D", "F[0,6s] in A & F in B & G !in D"],
  ["stay in C for 3 s", "F G[0,3s] in C"],
];
const REACH = [0.4, 0.4];

const mission = {
  title: "A robot makes its rounds",
  short: "A mission",
  intro: "A robot must see some places, in any order or in a given one, and keep out of another. It may avoid the walls, or turn at them. Drag the robot and the places, or move a slider:",
  room: [[0, 6], [0, 4]],
  knobs: [
    { key: "mission", label: "Mission", values: MISSIONS.map((_, k) => k), names: MISSIONS.map(([words]) => words) },
    restitution("Restitution of the walls"),
    ...velocities(2, 0.1),
    knob("maxSpeed", "Largest speed along each axis", "m/s", 0.5, 3, 0.1, 1),
    knob("maxAcceleration", "Largest acceleration along each axis", "m/s²", 0, 2, 0.1, 1),
    timeStep([0.5, 1]),
  ],
  handles: [body("start", "Robot", 0), ...["a", "b", "c"].map(name => place(name, name.toUpperCase(), REACH)), place("d", "not D", [0.6, 0.6]), arrow()],
  main: ["mission", "restitution"],
  arrow: 0.4,
  coarsest: 1,
  defaults: { mission: 0, restitution: 0.6, velocityX: 0, velocityY: 0, maxSpeed: 2, maxAcceleration: 0.6, timeStep: 0.5,
    startX: 1, startY: 0.6, aX: 0.8, aY: 3, bX: 5.2, bY: 3.2, cX: 5.2, cY: 0.8, dX: 3, dY: 2 },
  presets: {
    "In any order": {},
    "A, then B": { mission: 1 },
    "In time": { mission: 2 },
    "Wait in C": { mission: 3 },
    "D in the way": { mission: 1, dX: 3, dY: 3.2 },
  },
  task: state => ({
    timeStep: state.timeStep, longest: 15, room: mission.room, walls: true, restitution: state.restitution, impulseLimit: null,
    bodies: [{ name: "robot", mass: 1, start: [...point(state, "start"), state.velocityX, state.velocityY], goal: null,
      maxSpeed: state.maxSpeed, maxAcceleration: state.maxAcceleration }],
    obstacles: [],
    places: ["a", "b", "c", "d"].map(name => ({ name: name.toUpperCase(), sides: around(point(state, name), name === "d" ? [0.6, 0.6] : REACH) })),
    mission: MISSIONS[state.mission][1],
  }),
};

const gusts = {
  title: "One plan for all gusts",
  short: "Gusts",
  intro: "A puck must come to its goal, whatever gusts blow: its feedback answers them, which keeps every flight in a tube; a hundred are drawn. It may avoid the walls, or bank off them. Drag the puck, its goal and the block, or move a slider:",
  room: [[0, 2.5], [0, 1.5]],
  knobs: [
    knob("gusts", "Largest gust, each axis, a step", "m/s", 0, 0.02, 0.001, 3),
    restitution("Restitution of the walls"),
    knob("spread", "The restitution may be off by", "", 0, 0.2, 0.01, 2),
    ...velocities(3, 0.1),
    knob("maxSpeed", "Largest speed along each axis", "m/s", 0.5, 3, 0.1, 1),
    knob("maxAcceleration", "Largest acceleration along each axis", "m/s²", 0, 2, 0.1, 1),
    timeStep([0.25, 0.5]),
  ],
  handles: [body("start", "Puck", 0), goalOf([0.25, 0.25]), obstacle("block", "Block", [0.15, 0.45]), arrow()],
  main: ["gusts", "restitution"],
  arrow: 0.15,
  coarsest: 0.5,
  defaults: { gusts: 0.01, restitution: 0.3, spread: 0.1, velocityX: 1.8, velocityY: 0, maxSpeed: 2.4, maxAcceleration: 0.8, timeStep: 0.25,
    startX: 0.3, startY: 0.3, goalX: 1.7, goalY: 1.05, blockX: 1.15, blockY: 1.05 },
  presets: {
    "Around the block": {},
    "No wind": { gusts: 0, spread: 0 },
    "A storm": { gusts: 0.02 },
  },
  task: state => ({
    timeStep: state.timeStep, longest: 6, room: gusts.room, walls: true, restitution: state.restitution, impulseLimit: null,
    // A restitution is a number from 0 to 1, also where it is off.
    spread: millimetres(Math.min(state.spread, state.restitution, 1 - state.restitution)),
    bodies: [{ name: "puck", mass: 1, start: [...point(state, "start"), state.velocityX, state.velocityY],
      goal: [...point(state, "goal"), 0, 0], goalHalf: [0.25, 0.25, 0.5, 0.5], maxSpeed: state.maxSpeed, maxAcceleration: state.maxAcceleration,
      gusts: state.gusts }],
    obstacles: [{ name: "block", sides: around(point(state, "block"), [0.15, 0.45]) }],
  }),
};

export const KINDS = { wall, bank, pillar, exchange, mission, gusts };
