// Verdict, numbers and proofs. What belongs to an older task is dimmed until that of the newest comes.
import { SIDES } from "./charts.js";

const $ = selector => document.querySelector(selector);
const text = (side, selector, words) => { $(`[data-side=${side}] ${selector}`).textContent = words; };
/** A sentence without marks of names. */
const plain = sentence => sentence && sentence.replaceAll("`", "").replace(/^[a-z]/, letter => letter.toUpperCase());
const steps = count => `${count} ${count === 1 ? "step" : "steps"}`;

/** When the visitor is offered to stop, in ms. */
const LONG = 2000;
let saying = 0;
let offering = 0;

/** Dims what the page says, or no longer: then it is the answer to request `id`. */
export function setStale(on, sides = SIDES, id = 0) {
  for (const part of document.querySelectorAll("[data-answer]")) {
    if (part.dataset.side && !sides.includes(part.dataset.side)) continue;
    part.classList.toggle("stale", on);
    part.setAttribute("aria-busy", on);
    if (!on) part.dataset.of = id;
  }
  for (const button of document.querySelectorAll("[data-needs]")) button.disabled = on;
}

/** Planning began; what is known so far is said where the numbers come. */
export function begin() {
  saying ||= setTimeout(() => { $("#progress").textContent ||= "Planning …"; }, 250);
  clearTimeout(offering);
  offering = setTimeout(() => { $("#cancel").hidden = false; }, LONG);
}

export function end() {
  clearTimeout(saying);
  clearTimeout(offering);
  saying = 0;
  $("#progress").textContent = "";
  $("#cancel").hidden = true;
}

/** Says that the picture is a preview of a task, which is planned later as a `whole`; `null` for what is none. */
export function showPreview(task, whole) {
  const seconds = value => `${Number(value.toPrecision(3))} s`;
  $("#preview").textContent = !task ? "" : task.timeStep > whole.timeStep
    ? `Coarse preview: steps of ${seconds(task.timeStep)} instead of ${seconds(whole.timeStep)}.`
    : "Preview: a short search.";
}

/** How far the planner is: `refuted` steps are too few on one side. */
export function showProgress({ side, refuted }) {
  const where = { free: "without collisions", tolerant: "with collisions" }[side];
  $("#progress").textContent = `Planning${where ? ` ${where}` : ""} … ${refuted ? `refuted to ${steps(refuted)}` : ""}`;
}

export function showFailure(sentence) {
  $(".stage").classList.add("failed");
  $("#verdict").textContent = plain(sentence);
  $("#reason").textContent = "";
  for (const side of SIDES) showSide(side, null);
}

export function showCancelled() {
  end();
  $("#verdict").textContent = "Cancelled. Change something to plan again.";
  $("#reason").textContent = "";
  $("#verdict").classList.remove("stale");
}

export function showAnswer(found) {
  $(".stage").classList.toggle("failed", SIDES.every(side => !found[side].steps));
  $("#verdict").textContent = found.conclusion;
  $("#reason").textContent = plain(found.reason) ?? "";
  for (const side of SIDES) showSide(side, found[side]);
}

export function showSide(name, side) {
  text(name, ".seconds", side?.steps ? `${side.seconds.toFixed(3)} s` : "–");
  text(name, ".steps", side?.steps ? steps(side.steps) : side ? "no plan" : "");
  text(name, ".proof", side?.proof ?? "");
  text(name, ".hits", (side?.plan?.hits ?? []).map(hit =>
    `Hit: ${hit.contact} at ${hit.time.toFixed(2)} s with ${hit.speed.toFixed(2)} m/s, ${Math.hypot(...hit.impulse).toFixed(2)} N s.`).join(" "));
  text(name, ".why", "");
}

export function showReasons(reasons) {
  for (const name of SIDES) {
    const why = plain(reasons[name]);
    text(name, ".why", why ? `${why[0].toUpperCase()}${why.slice(1)}${/[.!?]$/.test(why) ? "" : "."}` : "");
  }
}
