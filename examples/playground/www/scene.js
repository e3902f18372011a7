// A scene seen from above, once without and once with collisions: the room, what can be dragged, the
// paths, and the bodies moving.
import { round, ticks, widthOf } from "./charts.js";
import { drawHandles, focus, focused } from "./handles.js";

const MARGIN = { left: 34, right: 12, top: 12, bottom: 24 };
const WORDS = { free: "Without collisions", tolerant: "With collisions" };

/** Metres to pixels and back, on equal axes. */
export class View {
  constructor(place, kind) {
    const [[left, right], [low, high]] = kind.room;
    this.width = widthOf(place);
    this.scale = (this.width - MARGIN.left - MARGIN.right) / (right - left);
    this.speed = kind.arrow * this.scale;
    this.height = Math.ceil((high - low) * this.scale) + MARGIN.top + MARGIN.bottom;
    this.room = kind.room;
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

/** The plan of a side: paths, hits and bodies. */
function drawPlan(view, side, { plan, isOlder }, task) {
  const numbers = plan.bodies.map((_, k) => k);
  const paths = numbers.map(k => `<path class="curve ${side} body-${k}" d="${path(view, plan, k)}"/>`).join("");
  const hits = plan.hits.map(hit => hitMark(view, side, hit)).join("");
  const movers = numbers.map(k => `<g class="mover">${shape(view, task.bodies[k], `body ${side} body-${k}`)}</g>`).join("");
  const flights = (plan.flights ?? []).map(corners => `M${corners.map(corner => view.at(corner)).join("L")}`).join("");
  const tube = (plan.tube ?? []).map(box => view.box(box, `tube ${side}`)).join("");
  return `<g class="plan ${side}${isOlder ? " older" : ""}" data-side="${side}">${tube}${flights && `<path class="flight ${side}" d="${flights}"/>`}${paths}${hits}${movers}</g>`;
}

/** How near a pointer asks for a sample, in pixels. */
const NEAR = 16;

/** The sample of the plans that is drawn nearest to a pixel, in words and with its place; `null` where there is none. */
function sampleAt(view, plans, [x, y]) {
  let best = null;
  for (const { timeStep, bodies, hits } of plans) for (const { name, position, velocity } of bodies) position.forEach((place, step) => {
    const at = [view.px(place[0]), view.py(place[1])], far = Math.hypot(at[0] - x, at[1] - y);
    if (far > NEAR || far >= (best?.far ?? Infinity)) return;
    // The hit of the step that leads here.
    const hit = hits.find(hit => hit.step === step - 1 && hit.body === name);
    const mode = step === 0 ? "start" : hit ? `after the hit of ${hit.contact}` : "free flight";
    best = { far, at, words: `${(step * timeStep).toFixed(2)} s, ${Math.hypot(...velocity[step]).toFixed(2)} m/s, ${mode}` };
  });
  return best;
}

/** Says the sample under the pointer. */
function tellSamples(place, view, plans) {
  const label = place.querySelector(".sample");
  place.onpointermove = event => {
    const frame = place.getBoundingClientRect();
    const found = event.buttons ? null : sampleAt(view, plans, [event.clientX - frame.left, event.clientY - frame.top]);
    label.setAttribute("visibility", found ? "visible" : "hidden");
    if (!found) return;
    const [x, y] = found.at, isRight = x > view.width / 2;
    label.setAttribute("transform", `translate(${x} ${y})`);
    label.innerHTML = `<circle r="3.5"/><text x="${isRight ? -9 : 9}" y="${y < 30 ? 18 : -9}" text-anchor="${isRight ? "end" : "start"}">${found.words}</text>`;
  };
  place.onpointerleave = () => label.setAttribute("visibility", "hidden");
}

/** Draws the plans of some sides in one picture; returns what moves their bodies. */
export function drawScene(place, sides, answer, kind, task, state) {
  const view = new View(place, kind);
  const shown = sides.filter(side => answer[side]?.plan);
  const outline = own => own.kind === "body" ? shape(view, task.bodies[own.body], "start")
    : own.kind !== "goal" ? shape(view, own, own.kind) : task.bodies[0].goalHalf ? shape(view, { half: task.bodies[0].goalHalf }, "goal") : "";
  const handles = drawHandles(view, kind, state, outline, sides.includes("free"));
  const own = focused(place);
  // A group, so that what can be moved is not hidden inside an image.
  place.innerHTML = `<svg viewBox="0 0 ${view.width} ${view.height}" height="${view.height}" role="group" aria-label="${sides.map(side => WORDS[side]).join(", ")}: the scene from above, in m">` +
    `${view.ground(task.walls)}${shown.map(side => drawPlan(view, side, answer[side], task)).join("")}${handles}<g class="sample" visibility="hidden"></g></svg>`;
  focus(place, own);
  tellSamples(place, view, shown.map(side => answer[side].plan));
  const groups = shown.map(side => [answer[side].plan, [...place.querySelectorAll(`.plan[data-side=${side}] .mover`)]]);
  return {
    view,
    show: time => {
      for (const [plan, movers] of groups) movers.forEach((mover, k) => mover.setAttribute("transform", `translate(${view.at(placeAt(plan, k, time))})`));
    },
  };
}
