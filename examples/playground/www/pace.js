// How coarsely is planned while something is being dragged: so coarsely that pictures come several times
// a second. What is planned in the end is never coarse.

/** A plan that takes longer is planned more coarsely the next time, in ms. */
const SLOW = 250;
/** One that takes less, less coarsely. */
const QUICK = 60;
const COARSEST = 3;
/** Changes that follow each other faster are a drag, also without a pointer, in ms. */
const DRAG = 300;

const levels = {};
let last = -Infinity;
let held = false;

/** Something changed: whether it is being dragged. */
export function isDrag() {
  const since = performance.now() - last;
  last = performance.now();
  return held || since < DRAG;
}

/** A task while it is being dragged: each level has twice the step of the one before, and scenes are hurried. */
export function preview(name, kind, task) {
  let { timeStep } = task, level = 0;
  while (level < (levels[name] ?? 0) && timeStep < kind.coarsest - 1e-9) [timeStep, level] = [Math.min(2 * timeStep, kind.coarsest), level + 1];
  const own = level ? { ...task, timeStep } : task;
  return "bodies" in own ? { ...own, hurried: true } : own;
}

/** Learns from a plan of a task that took so long, in ms. */
export function learn(name, isCoarse, took) {
  const level = levels[name] ?? 0;
  if (took > SLOW) levels[name] = isCoarse ? Math.min(COARSEST, level + 1) : Math.max(level, took > 2 * SLOW ? 2 : 1);
  else if (isCoarse && took < QUICK) levels[name] = Math.max(0, level - 1);
}

/** Listens to the pointer; `released` is called when it goes up. */
export function watchPointer(released) {
  addEventListener("pointerdown", event => { held = Boolean(event.target.closest?.("input, [data-handle]")); }, true);
  for (const end of ["pointerup", "pointercancel"]) {
    addEventListener(end, () => { if (held) { held = false; released(); } }, true);
  }
}

export const isHeld = () => held;
