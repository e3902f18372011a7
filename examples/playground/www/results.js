// Verdict, numbers and proofs. What belongs to an older task is dimmed until that of the newest comes.
import { drawBarriers, plain } from "./barrier.js";
import { SIDES } from "./charts.js";

const $ = selector => document.querySelector(selector);
const text = (side, selector, words) => { $(`[data-side=${side}] ${selector}`).textContent = words; };
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

const seconds = value => `${value.toFixed(3)} s`;

/** What is known of the shortest plan of a side: a figure, and words for it. */
function known(side) {
  if (!side) return ["–", ""];
  if (side.none) return ["–", "no plan"];
  if (side.found) return [seconds(side.seconds), steps(side.steps)];
  const least = side.refuted ? `at least ${seconds(side.least)}` : "";
  return side.steps ? [`≤ ${seconds(side.seconds)}`, `open${least && `, ${least}`}`] : ["open", least];
}

/** What is known of a side so far, while it is being searched. */
export function showBound(name, least) {
  text(name, ".seconds", "open");
  text(name, ".steps", `at least ${seconds(least)} so far`);
  for (const part of [".proof", ".hits", ".why"]) text(name, part, "");
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

/** The search was ended; `bounds` says which sides have a bound. */
export function showCancelled(bounds) {
  end();
  for (const name of bounds) text(name, ".steps", $(`[data-side=${name}] .steps`).textContent.replace(" so far", ""));
  $("#verdict").textContent = bounds.length ? "Cancelled: the numbers are what is known. Change something to plan again."
    : "Cancelled. Change something to plan again.";
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
  const [figure, words] = known(side);
  text(name, ".seconds", figure);
  text(name, ".steps", words);
  text(name, ".proof", side?.proof ?? "");
  const hits = (side?.plan?.hits ?? []).map(hit =>
    `Hit: ${hit.contact} at ${hit.time.toFixed(2)} s with ${hit.speed.toFixed(2)} m/s, ${Math.hypot(...hit.impulse).toFixed(2)} N s.`);
  text(name, ".hits", hits.length ? `${hits.join(" ")} Speeds and impulses are those of the law that the plan follows: it counts a hit at the end of its step.` : "");
  text(name, ".tells", tells(side));
  text(name, ".why", "");
}

/** What happens in the plan of a side. */
function tells(side) {
  const hits = side?.plan?.hits?.map(hit => hit.speed) ?? side?.curve?.impacts.map(hit => hit.before);
  if (!hits) return "";
  if (!hits.length) return "It touches nothing.";
  const hardest = `${Math.max(...hits).toFixed(2)} m/s`;
  return hits.length === 1 ? `One hit, with ${hardest}.` : `${hits.length} hits, the hardest with ${hardest}.`;
}

/** Why the answer is no better: in words with the proofs, and as the last part of the story. */
export function showReasons(reasons, found) {
  const asSentence = why => why && `${why}${/[.!?]$/.test(why) ? "" : "."}`;
  for (const name of SIDES) text(name, ".why", asSentence(plain(reasons[name]?.words)) ?? "");
  const name = ["tolerant", "free"].find(name => reasons[name]), side = found?.[name];
  $("#barrier-title").textContent = side?.none ? "Why there is no plan" : !side || side.found ? "Why nothing is faster" : "Why it takes longer";
  drawBarriers($("#barrier"), name && reasons[name], side, name === "free" ? "without collisions" : "with collisions");
}
