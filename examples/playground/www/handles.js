// What can be dragged, or moved by arrow keys: places, and the arrows of velocities. A picture that holds
// such things says where metres are (`px`, `py`) and how many pixels a metre and a metre per second
// have (`scale`, `speed`).
import { round } from "./charts.js";
import { numbers } from "./link.js";

/** Where an arrow begins, in pixels from the middle of its body: the tip of no velocity can be grabbed too. */
const RIM = 26;
/** How near a pointer takes hold of something, in pixels. */
const GRIP = 20;
/** From below to above: the goal is never hidden. */
const ORDER = ["place", "obstacle", "body", "velocity", "goal"];

/** Where the middle of something is, in pixels. */
export function pixelOf(view, kind, state, own) {
  if (own.kind !== "velocity") return [view.px(state[own.x]), own.y ? view.py(state[own.y]) : view.lane[own.kind]];
  const base = pixelOf(view, kind, state, kind.handles.find(({ name }) => name === own.of));
  const velocity = [state[own.x], own.y ? -state[own.y] : 0], speed = Math.hypot(...velocity);
  const along = speed ? velocity.map(part => part / speed) : [1, 0];
  return base.map((middle, k) => middle + along[k] * (RIM + speed * view.speed));
}

/** The numbers of the state that put something there. */
function numbersAt(view, kind, state, own, pixel) {
  let place = view.metres(...pixel);
  if (own.kind === "velocity") {
    const base = pixelOf(view, kind, state, kind.handles.find(({ name }) => name === own.of));
    const away = [pixel[0] - base[0], own.y ? base[1] - pixel[1] : 0], far = Math.hypot(...away) || 1;
    place = away.map(part => part / far * Math.max(0, far - RIM) / view.speed);
  }
  return [[own.x, place[0]], [own.y, place[1]]].filter(([key]) => key);
}

const side = (value, more, less) => `${Math.abs(value).toFixed(2)} m/s ${value < 0 ? less : more}`;

function said(state, own) {
  if (own.kind !== "velocity") return [own.x, own.y].filter(Boolean).map(key => `${state[key]} m`).join(", ");
  return [side(state[own.x], "to the right", "to the left"), ...(own.y ? [side(state[own.y], "up", "down")] : [])].join(", ");
}

/** The arrow of a velocity from its body to `[x, y]`, which is the origin. */
function arrow([bx, by], [x, y]) {
  const [dx, dy] = [x - bx, y - by], far = Math.hypot(dx, dy) || 1, [ux, uy] = [dx / far, dy / far];
  const back = Math.max(0, far - 12);
  const wing = (forward, left) => `${round(-forward * ux + left * uy)} ${round(-forward * uy - left * ux)}`;
  return `<path class="velocity" d="M${round(-back * ux)} ${round(-back * uy)}L${wing(6, 0)}"/><path class="tip" d="M0 0L${wing(11, 5)}L${wing(11, -5)}Z"/>`;
}

/** Draws what can be dragged. `shape(own)` is the outline of a body or an obstacle; only one of several pictures is for keys. */
export function drawHandles(view, kind, state, shape, focusable) {
  const inOrder = [...kind.handles].sort((a, b) => ORDER.indexOf(a.kind) - ORDER.indexOf(b.kind));
  return inOrder.map(own => {
    let [x, y] = pixelOf(view, kind, state, own), inside, high;
    if (own.kind === "velocity") {
      const base = pixelOf(view, kind, state, kind.handles.find(({ name }) => name === own.of));
      [x, y] = [Math.min(view.width - 10, Math.max(10, x)), Math.min(view.height - 10, Math.max(10, y))];
      [inside, high] = [arrow(base, [x, y]), null];
    } else if (own.kind === "goal") {
      [inside, high] = [view.goal?.(x) ?? `${shape(own)}<path class="goal" d="M-9 0H9M0 -9V9"/><circle class="goal" r="6"/>`, view.goal ? null : 25];
    } else [inside, high] = [shape(own), own.kind === "obstacle" ? Math.max(14 - y, -own.half[1] * view.scale - 6) : own.kind === "place" ? 4 : -13];
    const label = high === null ? "" : `<text class="tag" y="${round(high)}" text-anchor="middle">${own.label}</text>`;
    const words = `${own.label}: arrow keys ${own.kind === "velocity" ? "change" : "move"} it`;
    const { min, max } = numbers(kind).find(({ key }) => key === own.x);
    const role = focusable ? `tabindex="0" role="slider" aria-roledescription="movable" aria-label="${words}" ` +
      `aria-valuemin="${min}" aria-valuemax="${max}" aria-valuenow="${state[own.x]}" aria-valuetext="${said(state, own)}"` : 'aria-hidden="true"';
    return `<g class="handle ${own.kind}-handle" data-handle="${own.name}" transform="translate(${round(x)} ${round(y)})" ${role}>` +
      `<circle class="grip" r="${own.kind === "velocity" ? 14 : GRIP}"/>${inside}${label}</g>`;
  }).join("");
}

/** Which handle of a picture has the focus; `focus(name)` gives it back to that of a new picture. */
export const focused = place => place.contains(document.activeElement) ? document.activeElement.dataset.handle : null;
export const focus = (place, name) => name && place.querySelector(`[data-handle="${name}"][tabindex]`)?.focus({ preventScroll: true });

/**
 * Lets a visitor move what a picture shows. `scene()` is `{ view, kind, state }` of what is drawn, and
 * `change(pairs)` is told keys of the state with values.
 */
export function makeMovable(place, scene, change) {
  let held = null;
  const at = event => {
    const frame = place.getBoundingClientRect();
    return [event.clientX - frame.left, event.clientY - frame.top];
  };
  const ownOf = event => {
    const name = event.target.closest("[data-handle]")?.dataset.handle;
    return name && scene().kind.handles.find(own => own.name === name);
  };
  /** Of handles on top of each other, the one whose middle is nearest to the pointer. */
  const nearest = event => {
    const { view, kind, state } = scene(), top = ownOf(event), from = at(event);
    const far = own => Math.hypot(...pixelOf(view, kind, state, own).map((value, k) => value - from[k]));
    return top && kind.handles.filter(own => own === top || far(own) < GRIP).reduce((a, b) => far(b) < far(a) ? b : a);
  };
  // A touch of a handle is no scrolling: the style sheet says so too, to browsers that heed it on parts of an SVG.
  place.addEventListener("touchstart", event => { if (ownOf(event)) event.preventDefault(); }, { passive: false });
  place.addEventListener("pointerdown", event => {
    if (event.button) return;
    const own = nearest(event);
    if (!own) return;
    const { view, kind, state } = scene(), from = at(event);
    held = { own, view, kind, by: pixelOf(view, kind, state, own).map((value, k) => value - from[k]) };
    place.setPointerCapture(event.pointerId);
    focus(place, own.name);
    event.preventDefault();
  });
  place.addEventListener("pointermove", event => {
    if (held) change(numbersAt(held.view, held.kind, scene().state, held.own, at(event).map((value, k) => value + held.by[k])));
  });
  for (const end of ["pointerup", "pointercancel"]) place.addEventListener(end, () => { held = null; });
  place.addEventListener("keydown", event => {
    const own = ownOf(event), axis = /^Arrow(Left|Right)$/.test(event.key) ? own?.x : own?.y;
    const by = { ArrowLeft: -1, ArrowRight: 1, ArrowDown: -1, ArrowUp: 1 }[event.key];
    if (!axis || !by) return;
    event.preventDefault();
    change([[axis, by * (event.shiftKey ? 5 : 1)]], true);
  });
  return { isHeld: () => Boolean(held) };
}
