// What a visitor takes away: pictures, the plan, the program and the code.

const LOOKS = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-dasharray", "stroke-linejoin", "opacity",
  "visibility", "font-size", "font-family", "font-weight", "paint-order"];

export function download(name, type, text) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export async function copy(button, text) {
  const said = button.textContent;
  const done = await navigator.clipboard?.writeText(text).then(() => true, () => false);
  button.textContent = done ? "Copied" : "Cannot copy here";
  setTimeout(() => { button.textContent = said; }, 1500);
}

const escape = text => text.replace(/[&<>"]/g, sign => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[sign]);

/** A picture that looks as it does on the page, without the page. */
function alone(svg, y) {
  const copy = svg.cloneNode(true), originals = [svg, ...svg.querySelectorAll("*")];
  [copy, ...copy.querySelectorAll("*")].forEach((node, k) => {
    const style = getComputedStyle(originals[k]);
    node.setAttribute("style", LOOKS.map(look => `${look}:${style.getPropertyValue(look)}`).join(";").replaceAll('"', "'"));
    for (const name of [...node.attributes].map(attribute => attribute.name)) {
      if (/^(aria-|data-|tabindex|role|class)/.test(name)) node.removeAttribute(name);
    }
  });
  copy.querySelectorAll('[style*="visibility:hidden"]').forEach(node => node.remove());
  copy.setAttribute("y", y);
  copy.setAttribute("width", svg.viewBox.baseVal.width);
  return copy.outerHTML;
}

/** All pictures of the page in one, each under its title. */
export function asPicture(title) {
  const style = getComputedStyle(document.querySelector(".stage"));
  const words = (text, y, size) => `<text x="12" y="${y}" font-size="${size}" font-weight="600" fill="${style.color}">${escape(text)}</text>`;
  const parts = [words(title, 30, 20)];
  let [y, width] = [44, 300];
  for (const svg of document.querySelectorAll("main svg")) {
    if (svg.closest("#chip")) continue; // It is no picture of the task.
    const { width: wide, height: high } = svg.viewBox.baseVal;
    if (!svg.getClientRects().length) continue;
    const heading = svg.closest("figure")?.querySelector("figcaption") ?? svg.closest(".panel")?.querySelector("h2");
    if (heading) parts.push(words(heading.textContent.replace(/\s+/g, " ").trim(), y += 24, 14));
    parts.push(alone(svg, y + 8));
    [y, width] = [y + high + 8, Math.max(width, wide)];
  }
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${y + 16}" viewBox="0 0 ${width} ${y + 16}" font-family="sans-serif">` +
    `<rect width="100%" height="100%" fill="${style.backgroundColor}"/>${parts.join("")}</svg>\n`;
}
