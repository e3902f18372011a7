// The wall, the goal, the start with its velocity, and a vehicle for each plan.
import { SIDES, at, range, round, ticks, widthOf } from "./charts.js";
import { drawHandles, focus, focused } from "./handles.js";

const HEIGHT = 222, WALL = 22;
const LANES = { goal: 20, body: 56, free: 108, tolerant: 164 };
const BOTTOM = LANES.tolerant + 14;
const WORDS = { free: "without collisions", tolerant: "with collisions" };

/** Metres to pixels and back; as far as is seen now, and `least` metres. */
class Lane {
  constructor(place, far, least) {
    this.width = widthOf(place);
    this.height = BOTTOM;
    this.far = Math.max(far, least);
    this.scale = (this.width - WALL - 34) / this.far;
    this.speed = Math.min(12, this.width / 50);
    this.lane = LANES;
    this.px = x => round(WALL + Math.max(x, -0.5) * this.scale);
    this.metres = x => [(x - WALL) / this.scale];
    const left = goalIsFar => goalIsFar ? 'x="-12" text-anchor="end"' : 'x="12"';
    this.goal = x => `<line class="goal" y2="${BOTTOM - LANES.goal}"/><circle class="goal" r="6"/>` +
      `<text class="goal" y="4" ${left(x > this.width - 90)}>goal</text>`;
  }
}

/** `least` metres at least are seen, so that nothing moves away from the pointer that moves it. */
export function drawTrack(place, answer, kind, state, least) {
  const curves = Object.fromEntries(SIDES.map(side => [side, answer[side]?.curve]));
  const shown = SIDES.filter(side => curves[side]);
  const all = shown.flatMap(side => curves[side].position);
  const view = new Lane(place, range([0, state.start, state.goal, ...all], 0.4)[1], least), { px, width } = view;
  const lane = side => `<line class="rail" x1="${WALL}" x2="${width - 8}" y1="${LANES[side] + 14}" y2="${LANES[side] + 14}"/>` +
    `<text class="${side}" x="${width - 8}" y="${LANES[side] - 14}" text-anchor="end">${WORDS[side]}</text>`;
  const hits = shown.flatMap(side => curves[side].impacts.map((hit, k) =>
    `<g class="hits" data-side="${side}" data-time="${hit.time}" visibility="hidden"><path class="spark" d="M${WALL + 3} ${LANES[side]}l9 -13m-9 13l15 -5m-15 5l15 7"/></g>` +
    (k ? "" : `<text class="${side}" x="${WALL + 6}" y="${LANES[side] + 32}">hits at ${hit.before.toFixed(2)} m/s, leaves at ${hit.after.toFixed(2)} m/s</text>`)));
  const marks = ticks(0, view.far, width / 90).map(t => `<text x="${px(t)}" y="${HEIGHT - 4}" text-anchor="middle">${t}${t ? "" : " m"}</text>`);
  const bodies = shown.map(side => `<g class="vehicle${answer[side].isOlder ? " older" : ""}" data-side="${side}"><rect class="body ${side}" x="0" y="-9" width="22" height="18" rx="5"/><circle cx="5" cy="12" r="3.5" class="wall"/><circle cx="17" cy="12" r="3.5" class="wall"/></g>`);
  const start = () => '<rect class="start" x="0" y="-9" width="22" height="18" rx="5"/>';
  const own = focused(place);
  place.innerHTML = `<svg viewBox="0 0 ${width} ${HEIGHT}" height="${HEIGHT}" role="group" aria-label="the vehicle moving beside its wall, with and without collisions">` +
    `<rect class="wall" x="0" y="26" width="${WALL}" height="${BOTTOM - 26}" rx="2"/>` +
    `${["free", "tolerant"].map(lane).join("")}${marks.join("")}<g class="plan">${hits.join("")}${bodies.join("")}</g>${drawHandles(view, kind, state, start, true)}</svg>`;
  focus(place, own);
  const vehicles = [...place.querySelectorAll(".vehicle")];
  const sparks = [...place.querySelectorAll(".hits")];
  return {
    view,
    show: t => {
      for (const vehicle of vehicles) {
        const side = vehicle.dataset.side;
        vehicle.setAttribute("transform", `translate(${px(at(curves[side], "position", t))} ${LANES[side]})`);
      }
      for (const spark of sparks) {
        const since = t - Number(spark.dataset.time);
        spark.setAttribute("visibility", since >= 0 && since < 0.15 ? "visible" : "hidden");
      }
    },
  };
}
