"""Questions to a page, as scripts: each answers with a list of what is wrong."""

# Every text whose contrast is below 4.5, and every line and area of the charts below 3: WCAG 2, AA.
# Colours are blended with what is behind them, with the opacity of all that they are part of.
CONTRAST = """
const rgb = text => { const c = text.match(/[\\d.]+/g).map(Number); return c.length < 4 ? [...c, 1] : c; };
const light = ([r, g, b]) => { const f = c => (c /= 255) <= .03928 ? c / 12.92 : ((c + .055) / 1.055) ** 2.4;
  return .2126 * f(r) + .7152 * f(g) + .0722 * f(b); };
const over = (c, back) => [0, 1, 2].map(k => c[3] * c[k] + (1 - c[3]) * back[k]);
const behind = node => {
  if (!node) return [255, 255, 255];
  return over(rgb(getComputedStyle(node).backgroundColor), behind(node.parentElement));
};
const opacity = node => node ? Number(getComputedStyle(node).opacity) * opacity(node.parentElement) : 1;
const seen = node => node.checkVisibility() && node.getClientRects().length && getComputedStyle(node).visibility === "visible";
const bad = [], check = (node, colour, back, least, what) => {
  const c = rgb(colour);
  if (!c[3]) return;
  c[3] *= opacity(node);
  const [a, b] = [light(over(c, back)), light(back)];
  const ratio = (Math.max(a, b) + .05) / (Math.min(a, b) + .05);
  if (ratio < least) bad.push(`${node.tagName} ${node.className.baseVal ?? node.className} ${ratio.toFixed(2)}: ${what}`);
};
for (const node of document.querySelectorAll("body *")) {
  const own = [...node.childNodes].some(c => c.nodeType === 3 && c.textContent.trim());
  if (!own || !seen(node) || ["SCRIPT", "STYLE"].includes(node.tagName)) continue;
  const style = getComputedStyle(node), drawn = node.closest("svg");
  const room = drawn?.querySelector(".room"), back = room ? rgb(getComputedStyle(room).fill) : behind(node);
  check(node, drawn ? style.fill : style.color, back, 4.5, node.textContent.trim().slice(0, 40));
}
for (const node of document.querySelectorAll("svg .curve, svg .goal:not(text), svg .impulse, svg .hit, svg .start"))
  if (seen(node)) check(node, getComputedStyle(node).stroke, behind(node), 3, "line");
for (const node of document.querySelectorAll("svg .wall, svg .obstacle, svg .body:not(.body-1), svg .dot"))
  if (seen(node) && node.getAttribute("opacity") === null) check(node, getComputedStyle(node).fill, behind(node), 3, "area");
return bad;
"""

# Texts on top of each other, and controls that are less than 24 pixels high: WCAG 2.2, AA.
OVERLAPS = """
const boxes = [...document.querySelectorAll("main *, header *, nav *")]
  .filter(node => !node.closest("svg") && node.checkVisibility() && getComputedStyle(node).visibility === "visible"
    && [...node.childNodes].some(c => c.nodeType === 3 && c.textContent.trim()))
  .map(node => [node, node.getBoundingClientRect()]);
const bad = [];
for (const [k, [a, r]] of boxes.entries()) for (const [b, q] of boxes.slice(k + 1)) {
  if (a.contains(b) || b.contains(a)) continue;
  if (Math.min(r.right, q.right) - Math.max(r.left, q.left) > 1 && Math.min(r.bottom, q.bottom) - Math.max(r.top, q.top) > 1)
    bad.push(`${a.textContent.trim().slice(0, 30)} and ${b.textContent.trim().slice(0, 30)}`);
}
for (const node of document.querySelectorAll("button, input, nav a"))
  if (node.checkVisibility() && node.getBoundingClientRect().height < 24) bad.push(`${node.id || node.textContent} is too low`);
return bad;
"""
