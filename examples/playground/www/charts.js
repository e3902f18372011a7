// Charts as SVG text, as wide as their place, so that letters keep their size on every screen.

export const SIDES = ["free", "tolerant"];
export const round = value => Math.round(value * 100) / 100;

/** The width of a place; of a hidden one, any that can be drawn. */
export const widthOf = place => Math.max(place.clientWidth, 200);

/** Round numbers between two ends, about `count` of them. */
export function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(k => k * power).find(size => size >= rough);
  const list = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; k++) list.push(Number((k * step).toPrecision(10)));
  return list;
}

/** The range of some values, with a margin, never empty. */
export function range(values, least) {
  let low = Infinity, high = -Infinity;
  for (const value of values) { low = Math.min(low, value); high = Math.max(high, value); }
  if (low > high) [low, high] = [0, 1];
  const margin = Math.max(0.07 * (high - low), least);
  return [low - margin, high + margin];
}

export class Plane {
  constructor(width, height, x, y) {
    const [left, right, top, bottom] = [44, 14, 10, 26];
    Object.assign(this, { width, height, x, y, left, right, top, bottom });
    this.px = value => round(left + (value - x[0]) / (x[1] - x[0]) * (width - left - right));
    this.py = value => round(height - bottom - (value - y[0]) / (y[1] - y[0]) * (height - top - bottom));
  }

  axes() {
    const { px, py, left, right, top, bottom, width, height } = this;
    const cols = ticks(...this.x, width / 80).map(t =>
      `<line class="${t === 0 ? "zero" : "grid"}" x1="${px(t)}" x2="${px(t)}" y1="${top}" y2="${height - bottom}"/>` +
      `<text x="${px(t)}" y="${height - 8}" text-anchor="middle">${t}</text>`);
    const rows = ticks(...this.y, height / 42).map(t =>
      `<line class="${t === 0 ? "zero" : "grid"}" x1="${left}" x2="${width - right}" y1="${py(t)}" y2="${py(t)}"/>` +
      `<text x="${left - 6}" y="${py(t) + 4}" text-anchor="end">${t}</text>`);
    return cols.join("") + rows.join("");
  }

  path(xs, ys) {
    return xs.map((x, k) => `${k ? "L" : "M"}${this.px(x)} ${this.py(ys[k])}`).join("");
  }

  svg(label, inside) {
    return `<svg viewBox="0 0 ${this.width} ${this.height}" height="${this.height}" role="img" aria-label="${label}">${inside}</svg>`;
  }
}

/** One quantity of both plans over time. Returns what moves its cursor. */
export function drawCurves(place, name, curves) {
  const shown = SIDES.filter(side => curves[side]);
  const end = Math.max(0.01, ...shown.map(side => curves[side].time.at(-1)));
  const values = shown.flatMap(side => curves[side][name]);
  const plane = new Plane(widthOf(place), name === "position" ? 230 : 210, [0, end], range([0, ...values], 0.05));
  const held = name === "acceleration";
  const drawn = shown.map(side => {
    const { time, impacts } = curves[side], values = curves[side][name];
    let [xs, ys] = [time, values];
    if (held) {
      // Constant within a step; the last one is never applied.
      xs = time.slice(0, -1).flatMap((t, k) => [t, time[k + 1]]);
      ys = values.slice(0, -1).flatMap(a => [a, a]);
    }
    const hits = impacts.map(hit => `<circle class="hit ${side}" r="4.5" cx="${plane.px(hit.time)}" cy="${plane.py(
      name === "position" ? 0 : name === "velocity" ? -hit.before : at(curves[side], name, hit.time))}"/>`);
    return `<path class="curve ${side}" d="${plane.path(xs, ys)}"/>${hits.join("")}`;
  });
  const cursor = `<line class="cursor" y1="${plane.top}" y2="${plane.height - plane.bottom}" x1="0" x2="0"/>`;
  place.innerHTML = plane.svg(`${name} over time of both plans`, plane.axes() + drawn.join("") + cursor);
  const line = place.querySelector(".cursor");
  return {
    show: t => line.setAttribute("transform", `translate(${plane.px(Math.min(t, end))} 0)`),
    timeAt: x => Math.min(end, Math.max(0, (x - plane.left) / (plane.width - plane.left - plane.right) * end)),
  };
}

/** The phase plane: both plans, and the reach sets of one of them. */
export function drawPhase(place, curves, sets) {
  const shown = SIDES.filter(side => curves[side]);
  const x = range([0, ...shown.flatMap(side => curves[side].position)], 0.1);
  const speeds = shown.flatMap(side => [...curves[side].velocity, ...curves[side].impacts.flatMap(hit => [-hit.before, hit.after])]);
  const height = Math.min(640, Math.max(340, widthOf(place) * 1.02));
  const plane = new Plane(widthOf(place), height, x, range([0, ...speeds], 0.5));
  const outline = (kind, corners) => corners.length < 2 ? "" :
    `<polygon class="${kind}" points="${corners.map(([x, v]) => `${plane.px(x)},${plane.py(v)}`).join(" ")}"/>`;
  const areas = sets.map(set => `<g class="sets">${outline("reached", set.reached)}${outline("to-go", set.toGo)}</g>`).join("");
  const paths = shown.map(side => {
    const curve = curves[side];
    // An impact turns the velocity at the wall.
    const parts = curve.impacts.map(hit => `<path class="curve ${side}" stroke-dasharray="4 3" d="${plane.path([0, 0], [-hit.before, hit.after])}"/>` +
      `<circle class="hit ${side}" r="4.5" cx="${plane.px(0)}" cy="${plane.py(-hit.before)}"/>`);
    return `<path class="curve ${side}" d="${plane.path(curve.position, curve.velocity)}"/>${parts.join("")}`;
  });
  const wall = `<rect class="wall" opacity=".35" x="${plane.left}" y="${plane.top}" width="${Math.max(0, plane.px(0) - plane.left)}" height="${plane.height - plane.top - plane.bottom}"/>`;
  const clip = `<clipPath id="inside"><rect x="${plane.left}" y="${plane.top}" width="${plane.width - plane.left - plane.right}" height="${plane.height - plane.top - plane.bottom}"/></clipPath>`;
  const dots = shown.map(side => `<circle class="dot ${side}" r="5.5"/>`).join("");
  place.innerHTML = plane.svg("velocity over position of both plans, with reach sets",
    `${clip}${plane.axes()}<g clip-path="url(#inside)">${wall}${areas}${paths.join("")}</g>${dots}`);
  const groups = [...place.querySelectorAll(".sets")];
  return {
    show: t => {
      const nearest = sets.reduce((best, set, k) => Math.abs(set.time - t) < Math.abs(sets[best].time - t) ? k : best, 0);
      groups.forEach((group, k) => group.classList.toggle("now", k === nearest));
      for (const side of shown) {
        const dot = place.querySelector(`.dot.${side}`);
        dot.setAttribute("cx", plane.px(at(curves[side], "position", t)));
        dot.setAttribute("cy", plane.py(at(curves[side], "velocity", t)));
      }
    },
  };
}

/** A quantity of a plan at a time; between samples as the vehicle moves. */
export function at(curve, name, t) {
  const { time } = curve, step = time[1] - time[0] || 1, last = time.length - 1;
  const k = Math.min(last, Math.max(0, Math.floor(t / step + 1e-9)));
  if (k === last || name === "acceleration") return curve[name][k];
  const part = Math.min(1, Math.max(0, (t - time[k]) / step));
  return curve[name][k] + part * (curve[name][k + 1] - curve[name][k]);
}
