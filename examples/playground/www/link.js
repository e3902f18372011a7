// The state of a task: which numbers it holds, which values they take, and the link that holds it.
import { KINDS } from "./tasks.js";

/** What a state may hold: the sliders, and the coordinates of what can be dragged and has no slider. */
export function numbers(kind) {
  const slid = new Set(kind.knobs.map(knob => knob.key));
  const places = kind.handles.flatMap(own => [own.x, own.y].map((key, axis) => ({ key, axis, half: own.half?.[axis] })))
    .filter(({ key }) => key && !slid.has(key))
    .map(({ key, axis, half }) => ({ key, min: kind.room[axis][0] + half, max: kind.room[axis][1] - half, step: 0.05 }));
  return [...kind.knobs, ...places];
}

/** The nearest value that a number can take. */
export function allowed(kind, number, value) {
  if (!Number.isFinite(value)) return kind.defaults[number.key];
  if (number.values) return number.values.reduce((a, b) => Math.abs(b - value) < Math.abs(a - value) ? b : a);
  const { min, max, step } = number, [least, most] = [Math.ceil(min / step - 1e-9), Math.floor(max / step + 1e-9)];
  return Number((Math.min(most, Math.max(least, Math.round(value / step))) * step).toFixed(3));
}

/** The ends of a slider: a velocity and the largest speed stop each other. */
export function ends(kind, knob, state) {
  const { key, min, max, step } = knob, most = state[knob.within];
  if (knob.within) return [Math.min(state[key], Math.max(min, -most)), Math.max(state[key], Math.min(max, most))];
  const speeds = kind.knobs.filter(other => other.within === key).map(other => Math.abs(state[other.key]));
  const least = Math.ceil(Math.max(0, ...speeds) / step - 1e-9) * step;
  return [Math.min(state[key], Math.max(min, Number(least.toFixed(3)))), max];
}

/** The kind and the state that a link holds. */
export function readLink(hash) {
  const given = new URLSearchParams(hash.slice(1));
  const name = Object.hasOwn(KINDS, given.get("task")) ? given.get("task") : "wall";
  const kind = KINDS[name], state = { ...kind.defaults };
  for (const number of numbers(kind)) if (given.has(number.key)) state[number.key] = allowed(kind, number, Number(given.get(number.key)));
  return [name, state];
}

/** The link of a state: what differs from the defaults. */
export function link(name, state) {
  const changed = numbers(KINDS[name]).map(({ key }) => [key, state[key]]).filter(([key, value]) => value !== KINDS[name].defaults[key]);
  return new URLSearchParams(name === "wall" ? changed : [["task", name], ...changed]).toString();
}
