// A scene seen from above, once without and once with collisions: the room, what can be dragged, the
// paths, and the bodies moving.
import { round, ticks, widthOf } from "./charts.js";

const MARGIN = { left: 34, right: 12, top: 12, bottom: 24 };
const WORDS = { free: "Without collisions", tolerant: "With collisions" };

/** Metres to pixels and back, on equal axes. */
class View {
  constructor(place, room) {
    const [[left, right], [low, high]] = room;
    this.width = widthOf(place);
    this.scale = (this.width - MARGIN.left - MARGIN.right) / (right - left);
    this.height = Math.ceil((high - low) * this.scale) + MARGIN.top + MARGIN.bottom;
    this.room = room;
    this.px = x => round(MARGIN.left + (x - left) * this.scale);
    this.py = y => round(MARGIN.top + (high - y) * this.scale);
    this.metres = (x, y) => [left + (x - MARGIN.left) / this.scale, high - (y - MARGIN.top) / this.scale];
  }

  at([x, y]) { return `${this.px(x)} ${this.py(y)}`; }

  box([[left, right], [low, high]], name) {
    return `<rect class="${name}" x="${this.px(left)}" y="${this.py(high)}" width="${round((right - left) * this.scale)}" height="${round((high - low) * this.scale)}"/>`;
  }

  ground(walls) {
    const [[left, right], [low, high]] = this.room;
    const cols = ticks(left, right, this.width / 80).map(t => `<text x="${this.px(t)}" y="${this.height - 6}" text-anchor="middle">${t}</text>`);
    const rows = ticks(low, high, this.height / 60).map(t => `<text x="${MARGIN.left - 8}" y="${this.py(t) + 4}" text-anchor="end">${t}</text>`);
    return cols.join("") + rows.join("") + this.box(this.room, walls ? "room walls" : "room");
  }
}

/** The shape of a body around the origin. */
function shape(view, body, name) {
  const [w, h] = (body.half ?? [body.radius ?? 0, body.radius ?? 0]).map(size => Math.max(size * view.scale, 6));
  return `<rect class="${name}" x="${-w}" y="${-h}" width="${2 * w}" height="${2 * h}" rx="${body.half ? 2 : w}"/>`;
}

/** Where a body is at a time: on the parabola of its step, or on the way to and from a hit. */
export function placeAt(motion, number, time) {
  const { position, velocity, name } = motion.bodies[number], dt = motion.timeStep, last = position.length - 1;
  const step = Math.min(Math.max(0, Math.floor(time / dt + 1e-9)), last);
  if (step === last) return position[last];
  const part = Math.min(1, Math.max(0, time / dt - step)), from = position[step], to = position[step + 1];
  const hit = motion.hits.find(hit => hit.step === step && hit.body === name);
  const mix = (a, b, s) => a.map((value, k) => value + s * (b[k] - value));
  if (hit) {
    const when = Math.min(1 - 1e-6, Math.max(1e-6, hit.time / dt - step));
    return part < when ? mix(from, hit.place, part / when) : mix(hit.place, to, (part - when) / (1 - when));
  }
  return from.map((x, k) => (1 - part) ** 2 * x + 2 * part * (1 - part) * (x + 0.5 * dt * velocity[step][k]) + part ** 2 * to[k]);
}

/** The speed of a body over time, as a curve for the charts. */
export function speeds(motion, number) {
  const { velocity } = motion.bodies[number];
  return { time: velocity.map((_, k) => k * motion.timeStep), speed: velocity.map(v => Math.hypot(...v)), impacts: [] };
}

function path(view, motion, number) {
  const { position, velocity, name } = motion.bodies[number], dt = motion.timeStep;
  const legs = position.slice(1).map((end, step) => {
    const hit = motion.hits.find(hit => hit.step === step && hit.body === name);
    if (hit) return `L${view.at(hit.place)}L${view.at(end)}`;
    return `Q${view.at(position[step].map((x, k) => x + 0.5 * dt * velocity[step][k]))} ${view.at(end)}`;
  });
  return `M${view.at(position[0])}${legs.join("")}`;
}

/** A hit: a ring and an arrow along its impulse. */
function hitMark(view, side, hit) {
  const size = Math.hypot(...hit.impulse);
  const [x, y] = [view.px(hit.place[0]), view.py(hit.place[1])];
  const ring = `<circle class="hit ${side}" r="4.5" cx="${x}" cy="${y}"/>`;
  if (size < 1e-6) return ring;
  const [dx, dy] = [hit.impulse[0] / size, -hit.impulse[1] / size].map(round);
  const [tx, ty] = [x + 34 * dx, y + 34 * dy];
  return `${ring}<path class="impulse" d="M${x + 6 * dx} ${y + 6 * dy}L${tx} ${ty}m${round(-8 * dx - 4 * dy)} ${round(-8 * dy + 4 * dx)}L${tx} ${ty}l${round(-8 * dx + 4 * dy)} ${round(-8 * dy - 4 * dx)}"/>`;
}

function handle(view, task, state, own, focusable) {
  const [x, y] = [state[`${own.name}X`], state[`${own.name}Y`]];
  const inside = {
    obstacle: () => shape(view, own, "obstacle"),
    goal: () => `<path class="goal" d="M-9 0H9M0 -9V9"/><circle class="goal" r="6"/>`,
    body: () => shape(view, task.bodies[own.body], "start"),
  }[own.kind]();
  const high = { obstacle: () => -own.half[1] * view.scale - 6, goal: () => 25, body: () => -13 }[own.kind]();
  const label = `<text class="tag" y="${round(high)}" text-anchor="middle">${own.label}</text>`;
  const role = focusable ? `tabindex="0" role="slider" aria-roledescription="movable" aria-label="${own.label}: arrow keys move it" ` +
    `aria-valuemin="${view.room[0][0]}" aria-valuemax="${view.room[0][1]}" aria-valuenow="${x}" aria-valuetext="${x} m, ${y} m"` : `aria-hidden="true"`;
  return `<g class="handle" data-handle="${own.name}" transform="translate(${view.px(x)} ${view.py(y)})" ${role}><circle class="grip" r="22"/>${inside}${label}</g>`;
}

/** Draws one side; returns what moves its bodies. */
export function drawScene(place, side, motion, kind, task, state) {
  const view = new View(place, kind.room);
  const numbers = motion ? motion.bodies.map((_, k) => k) : [];
  const paths = numbers.map(k => `<path class="curve ${side} body-${k}" d="${path(view, motion, k)}"/>`).join("");
  const hits = motion ? motion.hits.map(hit => hitMark(view, side, hit)).join("") : "";
  const movers = numbers.map(k => `<g class="mover">${shape(view, task.bodies[k], `body ${side} body-${k}`)}</g>`).join("");
  const handles = kind.handles.map(own => handle(view, task, state, own, side === "free")).join("");
  const focused = place.contains(document.activeElement) ? document.activeElement.dataset.handle : null;
  // A group, so that what can be moved is not hidden inside an image.
  place.innerHTML = `<svg viewBox="0 0 ${view.width} ${view.height}" height="${view.height}" role="group" aria-label="${WORDS[side]}: the scene from above, in m">` +
    `${view.ground(task.walls)}<g class="plan">${paths}${hits}${movers}</g>${handles}</svg>`;
  if (focused) place.querySelector(`[data-handle="${focused}"]`).focus();
  const groups = [...place.querySelectorAll(".mover")];
  return {
    metres: view.metres,
    show: time => groups.forEach((group, k) => group.setAttribute("transform", `translate(${view.at(placeAt(motion, k, time))})`)),
  };
}

/**
 * Lets a visitor drag, or move by arrow keys, what a scene shows. `view()` is what is drawn,
 * `position(name)` is where something is, and `move(name, place)` moves it, all in m.
 */
export function makeMovable(place, view, position, move) {
  let held = null;
  const where = event => {
    const frame = place.getBoundingClientRect();
    return view().metres(event.clientX - frame.left, event.clientY - frame.top);
  };
  place.addEventListener("pointerdown", event => {
    const name = event.target.closest("[data-handle]")?.dataset.handle;
    if (!name || event.button) return;
    const at = where(event);
    held = { name, by: position(name).map((value, k) => value - at[k]) };
    place.setPointerCapture(event.pointerId);
    place.querySelector(`[data-handle="${name}"][tabindex]`)?.focus({ preventScroll: true });
    event.preventDefault();
  });
  place.addEventListener("pointermove", event => {
    if (held) move(held.name, where(event).map((value, k) => value + held.by[k]));
  });
  for (const end of ["pointerup", "pointercancel"]) place.addEventListener(end, () => { held = null; });
  place.addEventListener("keydown", event => {
    const name = event.target.closest("[data-handle]")?.dataset.handle, far = event.shiftKey ? 0.25 : 0.05;
    const by = { ArrowLeft: [-far, 0], ArrowRight: [far, 0], ArrowDown: [0, -far], ArrowUp: [0, far] }[event.key];
    if (!name || !by) return;
    event.preventDefault();
    move(name, position(name).map((value, k) => value + by[k]));
  });
}
