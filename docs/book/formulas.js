// Typesets formulas: a list of [TeX, is it a line of its own] comes in as JSON, a list of HTML goes out.
const { readFileSync } = require("fs");
const katex = require("katex");

const formulas = JSON.parse(readFileSync(0, "utf8"));
const html = formulas.map(([tex, displayMode]) =>
  katex.renderToString(tex, { displayMode, throwOnError: true, strict: "error" }));
process.stdout.write(JSON.stringify(html));
