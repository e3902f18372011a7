// The reason why one step less is not enough, drawn: what can be reached, what is needed, and the gap between.
import { round, widthOf } from "./charts.js";

const HEIGHT = 54;
/** The most that are drawn: plans with more hits are excluded alike. */
const MOST = 2;
/** A sentence without marks of names. */
export const plain = sentence => sentence && sentence.replaceAll("`", "").replace(/^[a-z]/, letter => letter.toUpperCase());
/** Tolerances are no digits. */
const short = value => Number(Number(value.toFixed(4)).toPrecision(3)).toString().replace("-", "−");

/** Draws the barriers of a reason, or says it in words if it has none. */
export function drawBarriers(place, reason, side, where) {
  place.replaceChildren();
  if (!reason || !side) return;
  const steps = side.found ? side.steps - 1 : side.refuted, said = document.createElement("p");
  said.className = "tells";
  place.append(said);
  const barriers = reason.barriers.slice(0, MOST);
  said.textContent = barriers.length ? `${steps} ${steps === 1 ? "step is" : "steps are"} too few, ${where}:` : `${plain(reason.words)}.`;
  for (const barrier of barriers) place.insertAdjacentHTML("beforeend", draw(widthOf(place), barrier));
}

/** Two ranges beside their gap, as far as that lets them be seen. */
function draw(width, { what, unit, plans, reached, needed }) {
  const isBelow = reached[1] !== null && needed[0] !== null && reached[1] < needed[0];
  const [from, to] = isBelow ? [reached[1], needed[0]] : [needed[1], reached[0]];
  if (from === null || to === null || !(from < to)) return "";
  const [left, right] = [0.36, 0.64].map(part => round(part * width)), [low, high] = isBelow ? ["reached", "to-go"] : ["to-go", "reached"];
  const label = `${what}${plans ? ` ${plans}` : ""}`, verb = name => name === "reached" ? "can be" : "must be";
  const [least, most] = [`${verb(low)} ≤ ${short(from)}`, `${verb(high)} ≥ ${short(to)}`];
  const end = (words, x, anchor) => `<text x="${x}" y="46" text-anchor="${anchor}">${words}</text>`;
  return `<svg viewBox="0 0 ${width} ${HEIGHT}" height="${HEIGHT}" role="img" aria-label="${label}: ${least}, ${most} ${unit}">` +
    `<text x="0" y="11">${label}</text><rect class="bar ${low}" x="1" y="18" width="${left - 1}" height="14"/>` +
    `<rect class="bar ${high}" x="${right}" y="18" width="${width - right - 1}" height="14"/>` +
    `<path class="missing" d="M${left} 25H${right}M${left} 18V32M${right} 18V32"/>` +
    `${end(least, left, "end")}${end(most, right, "start")}<text class="missing" x="${(left + right) / 2}" y="46" text-anchor="middle">${short(to - from)} ${unit}</text></svg>`;
}
