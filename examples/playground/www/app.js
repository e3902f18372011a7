// The page: sliders, things to drag and links hold the task, two workers plan it, the charts show the
// answer.
import { drawCurves, drawPhase, drawTrack } from "./charts.js";
import { drawScene, makeMovable, speeds } from "./plane.js";
import { Planners } from "./planners.js";
import { KINDS, allowed, link, numbers, readLink } from "./tasks.js";

const SIDES = ["free", "tolerant"];
const $ = selector => document.querySelector(selector);
const page = document.documentElement;
let [name, state] = readLink(location.hash);
let kind = KINDS[name];
let answer = null;
let planners = null;
let asked = { id: 0, at: 0 };
let views = [];
let shownTime = 0;
let playing = false;

// --- the task: sliders, link ---

function said(knob) {
  const value = state[knob.key];
  if (knob.none && value >= knob.max) return knob.none;
  return `${value.toFixed(knob.digits).replace("-", "−")}${knob.unit ? ` ${knob.unit}` : ""}`;
}

/** The words, sliders and examples of a kind of task. */
function showKind() {
  kind = KINDS[name];
  page.dataset.kind = name;
  $("#title").textContent = kind.title;
  $("#intro").textContent = kind.intro;
  $("#kinds").innerHTML = Object.entries(KINDS).map(([key, { short }]) =>
    `<a href="#${link(key, KINDS[key].defaults)}"${key === name ? ' aria-current="page"' : ""}>${short}</a>`).join("");
  $("#presets").innerHTML = Object.keys(kind.presets).map(label => `<button type="button" data-preset="${label}">${label}</button>`).join("");
  for (const part of document.querySelectorAll("[data-for]")) part.hidden = (part.dataset.for === "scene") !== Boolean(kind.room);
  $("#sliders").replaceChildren(...kind.knobs.map(makeSlider));
}

function makeSlider(knob) {
  const row = document.createElement("div");
  row.className = "slider";
  const [min, max, step] = knob.values ? [0, knob.values.length - 1, 1] : [knob.min, knob.max, knob.step];
  row.innerHTML = `<label for="${knob.key}">${knob.label}</label><output for="${knob.key}"></output>` +
    `<input id="${knob.key}" name="${knob.key}" type="range" min="${min}" max="${max}" step="${step}">`;
  knob.input = row.querySelector("input");
  knob.output = row.querySelector("output");
  knob.input.addEventListener("input", () => {
    const value = Number(knob.input.value);
    state[knob.key] = knob.values ? knob.values[value] : allowed(kind, knob, value);
    changed();
  });
  return row;
}

function showSliders() {
  for (const knob of kind.knobs) {
    const value = state[knob.key];
    knob.input.value = knob.values ? knob.values.indexOf(value) : value;
    knob.output.textContent = said(knob);
    knob.input.setAttribute("aria-valuetext", said(knob));
  }
}

/** Another kind of task, or another state of it: the pictures of the old one go. */
function begin() {
  stop();
  shownTime = 0;
  answer = null;
  showKind();
  changed();
}

function changed() {
  showSliders();
  const hash = link(name, state);
  history.replaceState(null, "", hash ? `#${hash}` : location.pathname + location.search);
  page.dataset.state = "planning";
  if (kind.room) draw();
  asked.at = performance.now();
  asked.id = planners.ask(kind.task(state), Boolean(kind.room));
  page.dataset.asked = asked.id;
  clearTimeout(asked.slow);
  asked.slow = setTimeout(() => { $("#took").textContent = "planning …"; }, 500);
}

/** Moves something of a scene to a place. */
function move(own, place) {
  const before = link(name, state);
  for (const number of numbers(kind)) {
    const axis = [`${own}X`, `${own}Y`].indexOf(number.key);
    if (axis >= 0) state[number.key] = allowed(kind, number, place[axis]);
  }
  if (link(name, state) === before) return;
  stop();
  changed();
}

// --- the answer ---

function heard({ id, answer: found, reasons, failure }) {
  if (failure) return fail(`The planner failed: ${failure}. Reload the page.`);
  if (reasons) return showReasons(id, reasons);
  clearTimeout(asked.slow);
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
  for (const side of SIDES) showSide(side, null);
  draw();
}

function show(found) {
  page.dataset.state = "planned";
  $(".stage").classList.toggle("failed", SIDES.every(side => !found[side].steps));
  $("#verdict").textContent = found.conclusion;
  for (const side of SIDES) showSide(side, found[side]);
  const start = !playing && shownTime === 0;
  draw();
  if (start && !matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
}

function showSide(name, side) {
  const text = (selector, words) => $(`[data-side=${name}] ${selector}`).textContent = words;
  text(".seconds", side?.steps ? `${side.seconds.toFixed(3)} s` : "–");
  text(".steps", side?.steps ? `${side.steps} ${side.steps === 1 ? "step" : "steps"}` : side ? "no plan" : "");
  text(".proof", side?.proof ?? "");
  text(".hits", (side?.plan?.hits ?? []).map(hit =>
    `Hit: ${hit.contact} at ${hit.time.toFixed(2)} s with ${hit.speed.toFixed(2)} m/s, ${Math.hypot(...hit.impulse).toFixed(2)} N s.`).join(" "));
  text(".why", "");
}

function showReasons(id, reasons) {
  for (const name of SIDES) {
    const why = reasons[name];
    $(`[data-side=${name}] .why`).textContent = why ? `${why[0].toUpperCase()}${why.slice(1)}.` : "";
  }
  page.dataset.explained = id;
}

// --- pictures ---

function draw() {
  views = kind.room ? drawScenes() : drawWall();
  const length = duration();
  $("#time").max = length;
  for (const control of [$("#time"), $("#play")]) control.disabled = !length;
  showTime(Math.min(shownTime, length));
}

function drawWall() {
  const curves = { free: answer?.free?.curve, tolerant: answer?.tolerant?.curve };
  const sets = answer?.tolerant?.sets?.length ? answer.tolerant.sets : answer?.free?.sets ?? [];
  const charts = ["position", "velocity", "acceleration"].map(name => drawChart($(`#chart-${name}`), name, curves));
  return [drawTrack($("#track"), curves, state), ...charts, drawPhase($("#phase"), curves, sets)];
}

function drawScenes() {
  const task = kind.task(state), motions = SIDES.map(side => answer?.[side]?.plan);
  const scenes = SIDES.map((side, k) => drawScene($(`#scene-${side}`), side, motions[k], kind, task, state));
  const charts = [0, 1].map(k => {
    const body = task.bodies[k], place = $(`#speed-${k}`), figure = place.closest("figure");
    figure.hidden = !body;
    if (!body) return [];
    figure.querySelector(".who").textContent = `${body.name[0].toUpperCase()}${body.name.slice(1)}`;
    const curves = Object.fromEntries(SIDES.map((side, i) => [side, motions[i] && speeds(motions[i], k)]));
    return drawChart(place, "speed", curves);
  });
  return [...scenes, ...charts.flat()];
}

/** A chart over time in which a visitor can point at a time. */
function drawChart(place, name, curves) {
  const view = drawCurves(place, name, curves);
  place.onpointermove = event => {
    if (!duration() || event.pointerType === "mouse" && !event.buttons) return;
    stop();
    showTime(view.timeAt(event.clientX - place.getBoundingClientRect().left));
  };
  return view;
}

/** Of the longer plan, in s; 0 if there is none. */
function duration() {
  return Math.max(...SIDES.map(side => answer?.[side]?.steps && (answer[side].curve ?? answer[side].plan) ? answer[side].seconds : 0));
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
  $("#presets").addEventListener("click", event => {
    const label = event.target.dataset.preset;
    if (!label) return;
    state = { ...kind.defaults, ...kind.presets[label] };
    stop();
    shownTime = 0;
    changed();
  });
  SIDES.forEach((side, k) => makeMovable($(`#scene-${side}`), () => views[k], own => [state[`${own}X`], state[`${own}Y`]], move));
  $("#link").addEventListener("click", async () => {
    await navigator.clipboard?.writeText(location.href).catch(() => {});
    $("#link").textContent = "Copied";
    setTimeout(() => $("#link").textContent = "Copy link", 1500);
  });
  $("#theme").addEventListener("click", () => {
    const dark = page.dataset.theme ? page.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    page.dataset.theme = dark ? "light" : "dark";
  });
  addEventListener("hashchange", () => { [name, state] = readLink(location.hash); begin(); });
  let width = innerWidth;
  addEventListener("resize", () => { if (innerWidth !== width) { width = innerWidth; draw(); } });
}

showKind();
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
