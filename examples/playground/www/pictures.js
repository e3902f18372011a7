// All pictures of an answer: the task with what can be dragged, and the plans as far as they are known.
import { SIDES, drawCurves, drawPhase } from "./charts.js";
import { drawScene, speeds } from "./scene.js";
import { drawTrack } from "./track.js";

const $ = selector => document.querySelector(selector);

/** Of the longer plan, in s; 0 if there is none. */
export const duration = answer =>
  Math.max(...SIDES.map(side => answer?.[side]?.steps && (answer[side].curve ?? answer[side].plan) ? answer[side].seconds : 0));

/**
 * The task, with what can be dragged and the plans. Returns what moves them. `before` is what this returned
 * the last time, while something is held; `isNarrow` says that one picture shows both plans.
 */
export function drawTask(kind, state, answer, before, isNarrow) {
  if (!kind.room) return [drawTrack($("#track"), answer ?? {}, kind, state, before?.[0].view.far ?? 0)];
  const task = kind.task(state);
  $("#scene-title").textContent = isNarrow ? "Without and with collisions" : "Without collisions";
  const shown = isNarrow ? { free: SIDES } : { free: ["free"], tolerant: ["tolerant"] };
  return Object.entries(shown).map(([place, sides]) => drawScene($(`#scene-${place}`), sides, answer ?? {}, kind, task, state));
}

/** The charts of an answer. `point(view)` lets a visitor point at a time. */
export function drawCharts(kind, state, answer, point) {
  return kind.room ? drawSpeeds(kind.task(state), answer, point) : drawCurvesAndSets(answer, point);
}

const curvesOf = answer => ({ free: answer?.free?.curve, tolerant: answer?.tolerant?.curve });

function drawCurvesAndSets(answer, point) {
  const curves = curvesOf(answer);
  const sets = answer?.tolerant?.sets?.length ? answer.tolerant.sets : answer?.free?.sets ?? [];
  const charts = ["position", "velocity", "acceleration"].map(name => chart($(`#chart-${name}`), name, curves, point));
  return [...charts, drawPhase($("#phase"), curves, sets)];
}

function drawSpeeds(task, answer, point) {
  return [0, 1].flatMap(k => {
    const body = task.bodies[k], place = $(`#speed-${k}`), figure = place.closest("figure");
    figure.hidden = !body;
    if (!body) return [];
    figure.querySelector(".who").textContent = `${body.name[0].toUpperCase()}${body.name.slice(1)}`;
    const motions = SIDES.map(side => answer?.[side]?.plan);
    const curves = Object.fromEntries(SIDES.map((side, i) => [side, motions[i] && speeds(motions[i], k)]));
    return [chart(place, "speed", curves, point)];
  });
}

function chart(place, name, curves, point) {
  const view = drawCurves(place, name, curves);
  place.onpointermove = event => {
    if (event.pointerType !== "mouse" || event.buttons) point(view.timeAt(event.clientX - place.getBoundingClientRect().left));
  };
  return view;
}
