// The page: sliders, things to drag and links hold the task, workers plan it, pictures show the answer.
import { SIDES } from "./charts.js";
import * as form from "./form.js";
import { makeMovable } from "./handles.js";
import { outdateLess, redrawLess, showLess } from "./less.js";
import { allowed, ends, link, numbers, readLink } from "./link.js";
import { loadPlanner, plannerFor } from "./load.js";
import * as pace from "./pace.js";
import { drawCharts, drawTask, duration } from "./pictures.js";
import { Planners } from "./planners.js";
import { Player } from "./player.js";
import * as results from "./results.js";
import { asPicture, copy, download } from "./save.js";
import { watchTable } from "./table.js";
import { KINDS } from "./tasks.js";

/** After so long without a change, what was planned coarsely is planned, and the reasons are asked for, in ms. */
const REST = 150;
/** After so long, a search tells what it knows where its result will stand, in ms. */
const LONG = 500;

const $ = selector => document.querySelector(selector);
const page = document.documentElement;
/** A phone: one picture for both plans. As in the style sheet. */
const NARROW = matchMedia("(max-width: 34rem)");
let [name, state] = readLink(location.hash);
let kind = KINDS[name];
let planners = null;
/** The name of the planner that is being loaded. */
let loading = "";
/** The last answer, of the task as it stands or of an older one. */
let answer = null;
/** The last request, and since when an answer is missing. */
let asked = { id: 0, at: 0, isCoarse: false };
/** What moves the pictures of the task, and the charts. */
let views = [];
let charted = { views: [] };
let redraw = 0;
let resting = 0;
let linking = 0;
let hasPlayed = false;
/** The sides of which a bound is shown while they are being searched. */
let bounded = [];

const player = new Player({ button: $("#play"), slider: $("#time"), clock: $("#clock"),
  show: time => { if (answer) [...views, ...charted.views].forEach(view => view.show(time)); } });

// --- the task ---

/** Another kind of task: the pictures and numbers of the old one go. */
function begin() {
  kind = KINDS[name];
  player.stop();
  player.time = 0;
  answer = null;
  hasPlayed = false;
  form.showKind(name, (key, value) => { state[key] = value; changed(); });
  for (const side of SIDES) results.showSide(side, null);
  $("#reason").textContent = "";
  results.showReasons({});
  results.showPreview(null);
  showLess(null);
  if (![plannerFor(kind), "all"].includes(planners?.name)) load(plannerFor(kind));
  $("#verdict").textContent = planners ? "Planning …" : "Loading the planner …";
  changed();
}

/** Loads another planner instead of the one that there is; of several that are asked for, the last one counts. */
async function load(name) {
  planners?.end();
  planners = null;
  asked = { id: 0, at: 0, isCoarse: false };
  page.dataset.asked = 0;
  delete page.dataset.drawn;
  delete page.dataset.explained;
  if (loading === name) return;
  loading = name;
  try {
    const { module, note } = await loadPlanner(name, words => { if (loading === name) $("#progress").textContent = words; });
    if (loading !== name) return;
    $("#note").textContent = note;
    planners = new Planners(name, module, heard);
    ask(false);
  } catch (error) {
    if (loading === name) fail(error.message, 0);
  } finally {
    if (loading === name) loading = "";
  }
}

/** The state changed: everything that belongs to the old one is out of date from now on. */
function changed() {
  form.showSliders(kind, state);
  results.setStale(true);
  outdateLess();
  page.dataset.state = "planning";
  draw();
  clearTimeout(linking);
  linking = setTimeout(saveLink, REST);
  const isDrag = pace.isDrag();
  if (planners) ask(isDrag);
}

function ask(isDrag) {
  clearTimeout(resting);
  const whole = kind.task(state), task = isDrag ? pace.preview(name, kind, whole) : whole;
  const isCoarse = task !== whole;
  bounded = [];
  results.begin();
  asked = { id: planners.plan({ task, isScene: Boolean(kind.room), name, isCoarse }), at: performance.now(), isCoarse };
  page.dataset.asked = asked.id;
}

/** A link holds the state. Browsers refuse to be told too often. */
function saveLink() {
  clearTimeout(linking);
  const hash = link(name, state);
  try {
    history.replaceState(null, "", hash ? `#${hash}` : location.pathname + location.search);
    $("#whole").href = location.href;
  } catch { /* The next one. */ }
}

/** Sets numbers, or moves them by so many steps of theirs. */
function move(pairs, bySteps) {
  const before = link(name, state);
  for (const number of numbers(kind)) {
    const pair = pairs.find(([key]) => key === number.key);
    if (!pair) continue;
    const [least, most] = number.label ? ends(kind, number, state) : [-Infinity, Infinity];
    const value = bySteps ? state[number.key] + pair[1] * number.step : pair[1];
    state[number.key] = allowed(kind, number, Math.min(most, Math.max(least, value)));
  }
  if (link(name, state) !== before) changed();
}

// --- the answer ---

function heard(message) {
  const { id, job } = message, isLatest = id === asked.id;
  if (message.replaced) return pace.learn(job.name, job.isCoarse, message.took);
  if (message.failure && job && job.what !== "plan") return isLatest && (job.what === "files" ? saveProgram({}) : showReasons(id, {}));
  if (message.failure) return isLatest && fail(`The planner failed: ${message.failure}. Change something, or reload the page.`, id);
  if (message.files) return isLatest && saveProgram(message.files);
  if (message.less !== undefined) return isLatest && showLess(message.less, answer, kind, state);
  if (message.reasons) return isLatest && showReasons(id, message.reasons);
  if (message.progress) return isLatest && !job.isCoarse && showProgress(message.progress, job.task.timeStep);
  pace.learn(job.name, job.isCoarse, message.took);
  if (job.name !== name) return;
  show(job.isCoarse ? withLastHits(message.answer) : message.answer);
  results.showPreview(job.isCoarse ? job.task : null, kind.task(state));
  page.dataset.pictures = Number(page.dataset.pictures ?? 0) + 1;
  if (!isLatest) return;
  if (job.isCoarse) resting = setTimeout(() => ask(false), REST);
  else settle(id, message);
}

/** The answer to the task as it stands has come, or none will. */
function settle(id, { answer: found, job }) {
  saveLink();
  results.end();
  results.setStale(false, SIDES, id);
  const error = found?.error ?? !found;
  page.dataset.state = error ? "failed" : "planned";
  $("#code").textContent = found?.code ?? "";
  $("#code-part").hidden = !found?.code;
  if (!found || found.error) showLess(null);
  const at = asked.at;
  requestAnimationFrame(() => {
    page.dataset.drawn = id;
    page.dataset.latency = (performance.now() - at).toFixed(1);
    $("#took").textContent = `planned and drawn in ${Math.round(performance.now() - at)} ms`;
  });
  if (error) return showReasons(id, {});
  // One step less than the shortest plan; without a plan, the longest one that was refuted.
  const steps = SIDES.map(side => found[side].found ? found[side].steps - 1 : found[side].refuted);
  resting = setTimeout(() => planners.also({ ...job, what: "explain", steps }), REST);
}

function show(found) {
  answer = found.error ? null : found;
  if (found.error) results.showFailure(found.error); else results.showAnswer(found);
  draw();
}

/** A short search that did not decide the side with collisions: the plan that was there stays, dimmed. */
function withLastHits(found) {
  const bold = found.tolerant;
  if (!bold || bold.found || bold.none) return found;
  const last = answer?.tolerant;
  const kept = last && (last.plan?.hits ?? last.curve?.impacts)?.length ? { ...last, isOlder: true } : { ...bold, plan: null, curve: null };
  return { ...found, tolerant: kept };
}

function fail(sentence, id) {
  answer = null;
  results.showPreview(null);
  results.showFailure(sentence);
  draw();
  settle(id, {});
}

function showReasons(id, reasons) {
  results.showReasons(reasons, answer);
  page.dataset.explained = id;
}

/** How far the planner is; one side may be known already. A bound is told once a search takes long. */
function showProgress(progress, timeStep) {
  const { side } = progress;
  results.showProgress(progress);
  if (!progress.found) {
    if (performance.now() - asked.at < LONG) return;
    if (!bounded.includes(side)) bounded.push(side);
    results.showBound(side, (progress.refuted + 1) * timeStep);
    return results.setStale(false, [side], asked.id);
  }
  bounded = bounded.filter(other => other !== side);
  answer = { ...answer, [progress.side]: progress.found };
  for (const side of SIDES) if (side !== progress.side) delete answer[side];
  results.showPreview(null);
  results.showSide(progress.side, progress.found);
  results.setStale(false, [progress.side], asked.id);
  draw();
}

function cancel() {
  planners.cancel();
  results.showCancelled(bounded);
  page.dataset.state = "cancelled";
  page.dataset.drawn = page.dataset.explained = asked.id;
}

/** The pictures, once a frame at most; the charts only where the answer is another one. */
function draw() {
  redraw ||= requestAnimationFrame(() => {
    redraw = 0;
    views = drawTask(kind, state, answer, pace.isHeld() && views[0]?.view ? views : null, NARROW.matches);
    if (charted.answer !== answer || charted.width !== innerWidth || charted.kind !== kind) {
      const point = time => { if (player.length) { player.stop(); player.at(time); } };
      charted = { answer, kind, width: innerWidth, views: drawCharts(kind, state, answer, point) };
    }
    player.begin(duration(answer));
    if (answer && !hasPlayed && player.length && page.dataset.state !== "planning") {
      hasPlayed = true;
      if (!matchMedia("(prefers-reduced-motion: reduce)").matches) player.play(true);
    }
  });
}

// --- the rest of the page ---

function saveProgram(files) {
  $("#save-mps").textContent = "Program (MPS)";
  $("#saved").textContent = files.mps ? "" : "There is no program of this task to save.";
  if (files.mps) download(`carom_${name}.mps`, "text/plain", files.mps);
}

function listen() {
  $("#presets").addEventListener("click", event => {
    const label = event.target.dataset.preset;
    if (!label) return;
    state = { ...kind.defaults, ...kind.presets[label] };
    player.stop();
    player.time = 0;
    hasPlayed = false;
    changed();
  });
  for (const [place, k] of [["#track", 0], ["#scene-free", 0], ["#scene-tolerant", 1]]) {
    makeMovable($(place), () => ({ view: views[k].view, kind, state }), (...change) => { player.stop(); move(...change); });
  }
  for (const part of document.querySelectorAll(".story [data-side]")) {
    const look = on => () => { if (on) page.dataset.look = part.dataset.side; else delete page.dataset.look; };
    for (const [begin, end] of [["pointerenter", "pointerleave"], ["focus", "blur"]]) {
      part.addEventListener(begin, look(true));
      part.addEventListener(end, look(false));
    }
  }
  pace.watchPointer(() => { if (asked.isCoarse) ask(false); });
  $("#cancel").addEventListener("click", cancel);
  $("#link").addEventListener("click", () => { saveLink(); copy($("#link"), location.href); });
  $("#copy").addEventListener("click", () => copy($("#copy"), $("#code").textContent));
  $("#save-svg").addEventListener("click", () => download(`carom_${name}.svg`, "image/svg+xml", asPicture(kind.title)));
  $("#save-json").addEventListener("click", () =>
    download(`carom_${name}.json`, "application/json", `${JSON.stringify({ task: kind.task(state), answer }, null, 1)}\n`));
  $("#save-mps").addEventListener("click", () => {
    $("#save-mps").textContent = "Writing …";
    planners?.also({ what: "files", task: kind.task(state), isScene: Boolean(kind.room), name });
  });
  $("#theme").addEventListener("click", () => {
    const dark = page.dataset.theme ? page.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    page.dataset.theme = dark ? "light" : "dark";
    // Read again in the head of the page, before it is drawn.
    try { localStorage.setItem("theme", page.dataset.theme); } catch { /* It lasts as long as the page. */ }
  });
  const folds = [...document.querySelectorAll(".fold")];
  const unfold = () => { for (const fold of folds) fold.open = !NARROW.matches; };
  unfold();
  NARROW.addEventListener("change", unfold);
  // What is folded has no width, and is drawn when it is opened.
  for (const fold of folds) fold.addEventListener("toggle", () => { if (fold.open) { charted = { views: [] }; draw(); redrawLess(); } });
  addEventListener("hashchange", () => { [name, state] = readLink(location.hash); begin(); });
  let width = innerWidth;
  addEventListener("resize", () => { if (innerWidth !== width) { width = innerWidth; draw(); redrawLess(); } });
  // In the site, the documentation is above this page.
  for (const part of document.querySelectorAll("[data-site]")) part.hidden = !/\/playground\/[^/]*$/.test(location.pathname);
}

listen();
begin();
watchTable();
