// The form: the kinds of tasks, their words, sliders and examples.
import { allowed, ends, link } from "./link.js";
import { KINDS } from "./tasks.js";

const $ = selector => document.querySelector(selector);

function said(knob, value) {
  if (knob.none && value >= knob.max) return knob.none;
  if (knob.names) return knob.names[knob.values.indexOf(value)];
  return `${value.toFixed(knob.digits).replace("-", "−")}${knob.unit ? ` ${knob.unit}` : ""}`;
}

/** The words, sliders and examples of a kind of task; `change(key, value)` hears the sliders. */
export function showKind(name, change) {
  const kind = KINDS[name];
  document.documentElement.dataset.kind = name;
  $("#title").textContent = kind.title;
  $("#intro").textContent = kind.intro;
  $("#kinds").innerHTML = Object.entries(KINDS).map(([key, { short, defaults }]) =>
    `<a href="#${link(key, defaults)}"${key === name ? ' aria-current="page"' : ""}>${short}</a>`).join("");
  $("#presets").innerHTML = Object.keys(kind.presets).map(label => `<button type="button" data-preset="${label}">${label}</button>`).join("");
  for (const part of document.querySelectorAll("[data-for]")) part.hidden = (part.dataset.for === "scene") !== Boolean(kind.room);
  const row = knob => slider(kind, knob, change), isMain = knob => kind.main.includes(knob.key);
  $("#sliders").replaceChildren(...kind.knobs.filter(isMain).map(row));
  $("#more-sliders").replaceChildren(...kind.knobs.filter(knob => !isMain(knob)).map(row));
}

function slider(kind, knob, change) {
  const row = document.createElement("div");
  row.className = "slider";
  const [min, max, step] = knob.values ? [0, knob.values.length - 1, 1] : [knob.min, knob.max, knob.step];
  row.innerHTML = `<label for="${knob.key}">${knob.label}</label><output for="${knob.key}"></output>` +
    `<input id="${knob.key}" name="${knob.key}" type="range" min="${min}" max="${max}" step="${step}">`;
  const input = row.querySelector("input");
  input.addEventListener("input", () => {
    const value = Number(input.value);
    change(knob.key, knob.values ? knob.values[value] : allowed(kind, knob, value));
  });
  return row;
}

export function showSliders(kind, state) {
  for (const knob of kind.knobs) {
    const value = state[knob.key], input = $(`#${knob.key}`);
    if (!knob.values) [input.min, input.max] = ends(kind, knob, state);
    input.value = knob.values ? knob.values.indexOf(value) : value;
    input.setAttribute("aria-valuetext", said(knob, value));
    input.parentElement.querySelector("output").textContent = said(knob, value);
  }
}
