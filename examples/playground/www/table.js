// A table for a chip: its answer for a state, by the code of a device, beside what a search has found beforehand.
import { compile } from "./load.js";
import { SOLVED } from "./solved_states.js";

const $ = selector => document.querySelector(selector);
const FILE = "pkg/table/table.wasm";
/** A look-up is timed for so long, in ms, once nothing has moved for as long as REST. */
const TIMED = 8, REST = 150;
/** The picture has so many places along each side. */
const PLACES = 40;
/** What the table says, as the numbers of `answer`. */
const [PLAN, NO_PLAN, OPEN] = [0, 1, 2];

const axes = [{ input: $("#chip-position"), unit: "m" }, { input: $("#chip-speed"), unit: "m/s" }];
let table = null;
let timing = 0;

const said = (value, unit, digits = 2) => `${value.toFixed(digits).replace("-", "−")} ${unit}`;
/** The state of the sliders. */
const read = () => axes.map(({ input }) => Number(input.value));

/** Loads the table once the section is seen. */
export function watchTable() {
  const section = $("#chip");
  const seen = new IntersectionObserver(entries => {
    if (!section.open || !entries.some(entry => entry.isIntersecting)) return;
    seen.disconnect();
    load();
  });
  seen.observe($("#chip-table"));
}

async function load() {
  try {
    const served = await fetch(new URL(`./${FILE}`, import.meta.url)).catch(() => {
      throw new Error("The table could not be loaded: the server of this page does not answer.");
    });
    if (!served.ok) throw new Error(`The table is missing: the server answers ${served.status} for ${FILE}.`);
    const bytes = await served.arrayBuffer();
    const { module } = await compile(new Uint8Array(bytes), FILE, "The table");
    table = (await WebAssembly.instantiate(module)).exports;
    begin(bytes.byteLength);
  } catch (error) {
    $("#chip-words").textContent = error.message;
  }
}

function begin(size) {
  for (const [k, { input }] of axes.entries()) {
    [input.min, input.max] = [table.end(k, 0), table.end(k, 1)];
    input.addEventListener("input", show);
  }
  const count = value => value.toLocaleString("en");
  $("#chip-size").textContent = `${count(table.cells())} cells, ${count(table.bytes())} bytes, at most ${table.depth()} cuts on the way to a cell; ` +
    `${count(size)} bytes with the code that looks it up`;
  const places = $("#chip-solved");
  for (const [x, v] of SOLVED) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = `${said(x, "m", 1)}, ${said(v, "m/s", 1)}`;
    button.addEventListener("click", () => set([x, v]));
    places.append(button);
  }
  draw();
  for (const part of document.querySelectorAll(".chip [data-loaded]")) part.hidden = false;
  set(SOLVED[0]);
}

function set(state) {
  for (const [k, { input }] of axes.entries()) input.value = state[k];
  show();
}

/** What the table says, and what a search has said beforehand if this is a state that it has solved. */
function show() {
  const state = read(), answer = table.answer(...state);
  for (const [k, { input, unit }] of axes.entries()) {
    const words = said(state[k], unit);
    input.setAttribute("aria-valuetext", words);
    input.parentElement.querySelector("output").textContent = words;
  }
  const { figure, words } = ofTable(state, answer);
  $("#chip-input").textContent = figure;
  $("#chip-words").textContent = words;
  const searched = ofSearch(state, answer);
  $("#chip-optimum").textContent = searched.figure;
  $("#chip-searched").textContent = searched.words;
  const at = $("#chip-picture .at");
  at.setAttribute("cx", place(0, state[0]));
  at.setAttribute("cy", place(1, state[1]));
  $("#chip").dataset.answer = answer;
  $("#chip-time").textContent = "";
  clearTimeout(timing);
  timing = setTimeout(time, REST);
}

function ofTable(state, answer) {
  if (answer === NO_PLAN) return { figure: "no plan", words: "Proved: no input keeps the cart within its limits. A chip falls back to a law of yours." };
  if (answer === OPEN) return { figure: "open", words: "Not decided: a border of the states with a plan, or of their modes, is near. A chip falls back to a law of yours." };
  if (answer !== PLAN) return { figure: "outside", words: "The table does not hold this state." };
  const cost = table.cost_of_plan(...state), loss = table.loss(...state);
  const proved = loss === Infinity ? "What it loses is not proved." : `Proved: it loses at most ${upward(loss)}, so that no plan costs ` +
    `less than ${Math.max(0, Math.floor((cost - loss) * 1000) / 1000).toFixed(3)}.`;
  return { figure: said(table.input(...state), "m/s²", 3), words: `Its plan costs ${cost.toFixed(3)}. ${proved}` };
}

/** A bound is rounded to the side on which it holds. */
const upward = value => (Math.ceil(value * 1000) / 1000).toFixed(3);

function ofSearch(state, answer) {
  const solved = SOLVED.find(([x, v]) => x === state[0] && v === state[1]);
  if (!solved) return { figure: "–", words: "Not searched: choose one of the states that a search has solved." };
  const [, , best] = solved;
  if (best === null) return { figure: "no plan", words: "A search of carom has refuted all plans from here." };
  const more = answer === PLAN ? ` The table's plan costs ${Math.max(0, table.cost_of_plan(...state) - best).toFixed(3)} more.` : "";
  return { figure: best.toFixed(3), words: `The least cost, as a search of carom has found it.${more}` };
}

/** The mean time of look-ups of this state, which are called from here. */
function time() {
  const [x, v] = read();
  let count = 0, took = 0;
  const began = performance.now();
  do {
    for (let k = 0; k < 1000; k++) table.input(x, v);
    count += 1000;
    took = performance.now() - began;
  } while (took < TIMED);
  const each = 1e6 * took / count;
  $("#chip-time").textContent = `A look-up takes ${each < 1000 ? `${Math.round(each)} ns` : `${(each / 1000).toFixed(1)} µs`} here: ` +
    `the mean of ${count.toLocaleString("en")}, just now.`;
}

// --- the picture: speeds over positions, coloured by the input ---

/** A number of an axis in the picture, whose sides are 0 to 100. */
function place(axis, value) {
  const [least, most] = [table.end(axis, 0), table.end(axis, 1)], share = (value - least) / (most - least);
  return 100 * (axis === 0 ? share : 1 - share);
}

function draw() {
  const size = 100 / PLACES;
  const value = (axis, k) => table.end(axis, 0) + (table.end(axis, 1) - table.end(axis, 0)) * (k + 0.5) / PLACES;
  let cells = "";
  for (let i = 0; i < PLACES; i++) for (let j = 0; j < PLACES; j++) {
    const state = [value(0, i), value(1, j)], answer = table.answer(...state), input = table.input(...state);
    const [kind, strong] = answer === PLAN ? [input < 0 ? "back" : "forth", Math.abs(input)] : [answer === NO_PLAN ? "none" : "open", 1];
    const [x, y] = [size * i, 100 - size * (j + 1)].map(number => number.toFixed(2));
    cells += `<rect class="${kind}" x="${x}" y="${y}" width="${size}" height="${size}" opacity="${(0.75 * strong).toFixed(2)}"/>`;
  }
  const picture = $("#chip-picture");
  const dots = SOLVED.map(([x, v]) => `<circle class="solved" cx="${place(0, x)}" cy="${place(1, v)}" r="1.3"/>`).join("");
  picture.innerHTML = `<svg viewBox="-3 -3 106 106" role="img" aria-label="The table's first input for each position and speed">` +
    `<g shape-rendering="crispEdges">${cells}</g>${dots}<circle class="at" r="2.6"/></svg>`;
  const svg = picture.querySelector("svg");
  const point = event => {
    const { left, top, width, height } = svg.getBoundingClientRect();
    const shares = [(event.clientX - left) / width, 1 - (event.clientY - top) / height].map(share => (share * 106 - 3) / 100);
    set(shares.map((share, k) => {
      const [least, most] = [table.end(k, 0), table.end(k, 1)];
      return Math.min(most, Math.max(least, least + share * (most - least)));
    }));
  };
  svg.addEventListener("pointerdown", event => { svg.setPointerCapture(event.pointerId); point(event); });
  svg.addEventListener("pointermove", event => { if (svg.hasPointerCapture(event.pointerId)) point(event); });
}
