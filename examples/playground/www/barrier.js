// The reason why one step less is not enough, drawn: what can be reached, what is needed, and the gap between.
import { round, widthOf } from "./charts.js";

const HEIGHT = 62, MARGIN = 8;
/** The most that are drawn: plans with more hits are excluded alike. */
const MOST = 2;
const short = value => Number(value.toPrecision(3)).toString().replace("-", "−");

/** Draws the barriers of a reason, or says it in words if it has none. */
export function drawBarriers(place, reason, side, where) {
  place.replaceChildren();
  if (!reason || !side) return;
  const steps = side.found ? side.steps - 1 : side.refuted, said = document.createElement("p");
  said.className = "tells";
  place.append(said);
  const barriers = reason.barriers.slice(0, MOST);
  said.textContent = barriers.length ? `${steps} ${steps === 1 ? "step is" : "steps are"} too few, ${where}:` : `${reason.words.replaceAll("`", "")}.`;
  for (const barrier of barriers) place.insertAdjacentHTML("beforeend", draw(widthOf(place), barrier));
}

function draw(width, { what, unit, plans, reached, needed }) {
  const ends = [...reached, ...needed].filter(end => end !== null);
  const low = Math.min(...ends), wide = Math.max(...ends) - low || 1;
  // Room for what is open on either side.
  const px = value => round(MARGIN + (0.14 + 0.72 * (value - low) / wide) * (width - 2 * MARGIN));
  const bar = (name, [from, to], y) => {
    const [left, right] = [from === null ? MARGIN : px(from), to === null ? width - MARGIN : px(to)];
    return `<rect class="bar ${name}" x="${left}" y="${y}" width="${Math.max(2, round(right - left))}" height="12" rx="2"/>`;
  };
  const isBelow = reached[1] !== null && needed[0] !== null && reached[1] < needed[0];
  const [from, to] = isBelow ? [reached[1], needed[0]] : [needed[1], reached[0]];
  const isApart = from !== null && to !== null && from < to, label = `${what}${plans ? ` ${plans}` : ""}`;
  const gap = !isApart ? "" : `<path class="missing" d="M${px(from)} 43H${px(to)}M${px(from)} 39V47M${px(to)} 39V47"/>` +
    `<text class="missing" x="${round(Math.min(width - 60, Math.max(60, (px(from) + px(to)) / 2)))}" y="59" text-anchor="middle">${short(to - from)} ${unit} are missing</text>`;
  const said = (range, words) => `${words} ${range.map(end => end === null ? "…" : short(end)).join(" to ")} ${unit}`;
  return `<svg viewBox="0 0 ${width} ${HEIGHT}" height="${HEIGHT}" role="img" aria-label="${label}: ${said(reached, "can be")}, ${said(needed, "has to be")}">` +
    `<text x="${MARGIN}" y="11">${label}</text>${bar("reached", reached, 18)}${bar("to-go", needed, 32)}${gap}</svg>`;
}
