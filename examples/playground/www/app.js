// The page: sliders and links hold the task, two workers plan it, the charts show the answer.
import { drawCurves, drawPhase, drawTrack } from "./charts.js";
import { Planners } from "./planners.js";

const NO_LIMIT = 20;
const STEPS = [0.005, 0.01, 0.02, 0.025, 0.05, 0.1, 0.2, 0.5];
const KNOBS = [
  { key: "start", label: "Start", unit: "m", min: -1, max: 15, step: 0.1, digits: 1 },
  { key: "velocity", label: "Velocity at the start", unit: "m/s", min: -16, max: 16, step: 0.5, digits: 1 },
  { key: "goal", label: "Goal", unit: "m", min: -1, max: 8, step: 0.05, digits: 2 },
  { key: "restitution", label: "Restitution of the wall", unit: "", min: 0, max: 1, step: 0.005, digits: 3 },
  { key: "impactLimit", label: "Largest impact speed", unit: "m/s", min: 0, max: NO_LIMIT, step: 0.05, digits: 2, none: "no limit" },
  { key: "maxSpeed", label: "Largest speed", unit: "m/s", min: 0.5, max: 20, step: 0.5, digits: 1 },
  { key: "maxAcceleration", label: "Largest acceleration", unit: "m/s²", min: 0, max: 12, step: 0.25, digits: 2 },
  { key: "timeStep", label: "Time step", unit: "s", values: STEPS, digits: 3 },
];
const PAPER = { start: 10, velocity: 0, goal: 0.3, restitution: 0, impactLimit: NO_LIMIT, maxSpeed: 15, maxAcceleration: 6, timeStep: 0.005 };
const PRESETS = {
  paper: {},
  table3: { restitution: 0.025 },
  bounce: { restitution: 0.5 },
  gentle: { impactLimit: 6.2 },
  saved: { start: 4, velocity: -10, restitution: 0.3 },
  none: { start: 4, velocity: -10, restitution: 0.3, impactLimit: 4 },
};

const $ = selector => document.querySelector(selector);
const page = document.documentElement;
let state = { ...PAPER };
let answer = null;
let planners = null;
let asked = { id: 0, at: 0 };
let views = [];
let shownTime = 0;
let playing = false;

// --- the task: sliders, link ---

/** The nearest value that a slider can take. */
function allowed(knob, value) {
  if (!Number.isFinite(value)) return PAPER[knob.key];
  if (knob.values) return knob.values.reduce((a, b) => Math.abs(b - value) < Math.abs(a - value) ? b : a);
  const steps = Math.round((Math.min(knob.max, Math.max(knob.min, value)) - knob.min) / knob.step);
  return Number((knob.min + steps * knob.step).toFixed(3));
}

function readLink() {
  const given = new URLSearchParams(location.hash.slice(1));
  state = { ...PAPER };
  for (const knob of KNOBS) if (given.has(knob.key)) state[knob.key] = allowed(knob, Number(given.get(knob.key)));
}

function writeLink() {
  const changed = KNOBS.filter(({ key }) => state[key] !== PAPER[key]).map(({ key }) => [key, state[key]]);
  const hash = new URLSearchParams(changed).toString();
  history.replaceState(null, "", hash ? `#${hash}` : location.pathname + location.search);
}

function said(knob) {
  const value = state[knob.key];
  if (knob.none && value >= knob.max) return knob.none;
  return `${value.toFixed(knob.digits).replace("-", "−")}${knob.unit ? ` ${knob.unit}` : ""}`;
}

function makeSliders() {
  for (const knob of KNOBS) {
    const row = document.createElement("div");
    row.className = "slider";
    const [min, max, step] = knob.values ? [0, knob.values.length - 1, 1] : [knob.min, knob.max, knob.step];
    row.innerHTML = `<label for="${knob.key}">${knob.label}</label><output for="${knob.key}"></output>` +
      `<input id="${knob.key}" name="${knob.key}" type="range" min="${min}" max="${max}" step="${step}">`;
    $("#sliders").append(row);
    knob.input = row.querySelector("input");
    knob.output = row.querySelector("output");
    knob.input.addEventListener("input", () => {
      const value = Number(knob.input.value);
      state[knob.key] = knob.values ? knob.values[value] : allowed(knob, value);
      changed();
    });
  }
}

function showSliders() {
  for (const knob of KNOBS) {
    const value = state[knob.key];
    knob.input.value = knob.values ? knob.values.indexOf(value) : value;
    knob.output.textContent = said(knob);
    knob.input.setAttribute("aria-valuetext", said(knob));
  }
}

function changed() {
  showSliders();
  writeLink();
  page.dataset.state = "planning";
  const impactLimit = state.impactLimit >= NO_LIMIT ? null : state.impactLimit;
  asked.at = performance.now();
  asked.id = planners.ask({ ...state, impactLimit });
  page.dataset.asked = asked.id;
}

// --- the answer ---

function heard({ id, answer: found, reasons, failure }) {
  if (failure) return fail(`The planner failed: ${failure}. Reload the page.`);
  if (reasons) return showReasons(reasons);
  answer = found;
  if (found.error) fail(found.error); else show(found);
  requestAnimationFrame(() => {
    page.dataset.drawn = id;
    page.dataset.latency = (performance.now() - asked.at).toFixed(1);
    $("#took").textContent = `planned and drawn in ${Math.round(performance.now() - asked.at)} ms`;
  });
}

function fail(sentence) {
  answer = null;
  page.dataset.state = "failed";
  $(".stage").classList.add("failed");
  $("#verdict").textContent = sentence;
  for (const side of ["free", "tolerant"]) showSide(side, null);
  draw();
}

function show(found) {
  page.dataset.state = "planned";
  $(".stage").classList.toggle("failed", !found.free.curve && !found.tolerant.curve);
  $("#verdict").textContent = found.conclusion;
  for (const side of ["free", "tolerant"]) showSide(side, found[side]);
  const start = !playing && shownTime === 0;
  draw();
  if (start && !matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
}

function showSide(name, side) {
  const text = (selector, words) => $(`[data-side=${name}] ${selector}`).textContent = words;
  text(".seconds", side?.steps ? `${side.seconds.toFixed(3)} s` : "–");
  text(".steps", side?.steps ? `${side.steps} ${side.steps === 1 ? "step" : "steps"}` : side ? "no plan" : "");
  text(".proof", side?.proof ?? "");
  text(".why", "");
}

function showReasons(reasons) {
  for (const name of ["free", "tolerant"]) {
    const why = reasons[name];
    $(`[data-side=${name}] .why`).textContent = why ? `${why[0].toUpperCase()}${why.slice(1)}.` : "";
  }
  page.dataset.explained = page.dataset.drawn;
}

// --- pictures ---

function draw() {
  const curves = { free: answer?.free?.curve, tolerant: answer?.tolerant?.curve };
  const sets = answer?.tolerant?.sets?.length ? answer.tolerant.sets : answer?.free?.sets ?? [];
  views = [
    drawTrack($("#track"), curves, state),
    ...["position", "velocity", "acceleration"].map(name => {
      const place = $(`#chart-${name}`);
      const view = drawCurves(place, name, curves);
      place.onpointermove = event => {
        if (event.pointerType === "mouse" && !event.buttons) return;
        stop();
        showTime(view.timeAt(event.clientX - place.getBoundingClientRect().left));
      };
      return view;
    }),
    drawPhase($("#phase"), curves, sets),
  ];
  $("#time").max = duration();
  showTime(Math.min(shownTime, duration()));
}

function duration() {
  const ends = ["free", "tolerant"].map(side => answer?.[side]?.curve?.time.at(-1) ?? 0);
  return Math.max(...ends, 0.001);
}

function showTime(time) {
  shownTime = time;
  if (answer) views.forEach(view => view.show(time));
  $("#time").value = time;
  $("#time").setAttribute("aria-valuetext", `${time.toFixed(2)} s`);
  $("#clock").textContent = `${time.toFixed(2)} s`;
}

let frame = 0;
function play(on) {
  playing = on;
  $("#play").textContent = on ? "❚❚" : "▶";
  $("#play").setAttribute("aria-label", on ? "Pause" : "Play");
  cancelAnimationFrame(frame);
  if (!on) return;
  let last = performance.now();
  const tick = now => {
    const next = shownTime + (now - last) / 1000;
    last = now;
    if (next >= duration()) {
      showTime(duration());
      return play(false);
    }
    showTime(next);
    frame = requestAnimationFrame(tick);
  };
  frame = requestAnimationFrame(tick);
}
const stop = () => playing && play(false);

// --- the rest of the page ---

function listen() {
  $("#play").addEventListener("click", () => {
    if (!playing && shownTime >= duration() - 1e-6) showTime(0);
    play(!playing);
  });
  $("#time").addEventListener("input", () => { stop(); showTime(Number($("#time").value)); });
  for (const button of document.querySelectorAll("[data-preset]")) {
    button.addEventListener("click", () => {
      state = { ...PAPER, ...PRESETS[button.dataset.preset] };
      stop();
      shownTime = 0;
      changed();
    });
  }
  $("#link").addEventListener("click", async () => {
    await navigator.clipboard?.writeText(location.href).catch(() => {});
    $("#link").textContent = "Copied";
    setTimeout(() => $("#link").textContent = "Copy link", 1500);
  });
  $("#theme").addEventListener("click", () => {
    const dark = page.dataset.theme ? page.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    page.dataset.theme = dark ? "light" : "dark";
  });
  addEventListener("hashchange", () => { readLink(); changed(); });
  let width = innerWidth;
  addEventListener("resize", () => { if (innerWidth !== width) { width = innerWidth; draw(); } });
}

readLink();
makeSliders();
showSliders();
listen();
try {
  const response = await fetch(new URL("./pkg/carom_playground_bg.wasm", import.meta.url));
  const module = await WebAssembly.compileStreaming(response.clone()).catch(async () => WebAssembly.compile(await response.arrayBuffer()));
  planners = new Planners(module, heard);
  changed();
} catch (error) {
  fail(`The planner could not be loaded: ${error}. The page needs WebAssembly and a web server that serves this folder.`);
}
