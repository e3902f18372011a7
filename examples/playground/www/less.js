// One step less than the shortest plan, as sets: where the bodies can be after so many steps, and from where
// the goal can still be reached in what is left. They do not meet.
import { Plane, range, widthOf } from "./charts.js";
import { Player } from "./player.js";
import { View } from "./scene.js";

const $ = selector => document.querySelector(selector);
let shown = null;
/** The steps of which there are sets. */
let at = [];
let last = [];

const player = new Player({
  button: $("#less-play"), slider: $("#less-time"), clock: $("#less-clock"),
  show: step => shown?.(Math.round(step)),
  words: step => `step ${at[Math.round(step)] ?? 0}`,
  rate: () => player.length / 4,
});

/** What is shown belongs to an older task. */
export const outdateLess = () => $("#less").classList.add("stale");

/** The same again, in a window of another width. */
export const redrawLess = () => showLess(...last);

/** Draws `less`, or hides the figure if there is nothing to draw. */
export function showLess(less, answer, kind, state) {
  last = [less, answer, kind, { ...state }];
  at = less?.at ?? [];
  $("#less").hidden = !at.length;
  $("#less").classList.remove("stale");
  player.stop();
  if (!at.length) return;
  const side = less.side === "free" ? "without collisions" : "with collisions";
  const why = answer[less.side].found ? "Why nothing is faster" : answer[less.side].none ? "Why there is no plan" : "Why it takes longer";
  $("#less-title").textContent = `${why}: not ${less.steps} ${less.steps === 1 ? "step" : "steps"}, ${side}`;
  $("#less-words").textContent = kind.room ? "Drawn are places; with velocities, the two never meet: so there is no such plan. Move the slider to see where they pass each other."
    : "Drawn are velocities (m/s) over positions (m); the two never meet: so there is no such plan.";
  const place = $("#less-picture"), { px, py, svg, ground } = frame(place, less, kind, state);
  const area = (name, corners) => corners.length < 2 ? "" : `<polygon class="${name}" points="${corners.map(([x, y]) => `${px(x)},${py(y)}`).join(" ")}"/>`;
  const areas = k => less.forward[k].map(set => area("reached", set)).join("") + less.backward[k].map(set => area("to-go", set)).join("");
  // Faint, about thirty of all; and a moment of them.
  const all = at.map((_, k) => k).filter(k => k % Math.ceil(at.length / 30) === 0);
  place.innerHTML = svg(`${ground}<g class="sets">${all.map(areas).join("")}</g><g class="sets now"></g>`);
  const moment = place.querySelector(".now");
  shown = k => { moment.innerHTML = areas(k); };
  player.time = Math.floor(at.length / 2);
  player.begin(at.length - 1);
}

function frame(place, less, kind, state) {
  if (kind.room) {
    const view = new View(place, kind), task = kind.task(state);
    const blocks = task.obstacles.map(({ sides }) => view.box(sides, "obstacle")).join("");
    const label = "where the body can be, and from where it can still be at its goal in time, step by step";
    return { px: view.px, py: view.py, ground: view.ground(task.walls) + blocks,
      svg: inside => `<svg viewBox="0 0 ${view.width} ${view.height}" height="${view.height}" role="img" aria-label="${label}">${inside}</svg>` };
  }
  const corners = [...less.forward, ...less.backward].flat(2);
  const plane = new Plane(widthOf(place), 380, range(corners.map(([x]) => x), 0.1), range(corners.map(([, v]) => v), 0.1));
  return { px: plane.px, py: plane.py, ground: plane.axes(), svg: inside => plane.svg("sets of one step less, velocity over position", inside) };
}
