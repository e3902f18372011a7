// The frame of the playground is as high as what is in it.
addEventListener("message", ({ data, source }) => {
  const frame = [...document.querySelectorAll(".landing iframe")].find(frame => frame.contentWindow === source);
  if (frame && data?.height > 0) frame.style.height = `${Math.min(Math.ceil(data.height) + 2, 4000)}px`;
});
// The button of the table of contents, which mdBook writes as the label of a box that is not shown.
document.getElementById("mdbook-sidebar-toggle")?.addEventListener("click", () => {
  document.getElementById("mdbook-sidebar-toggle-anchor").click();
});
// Code that goes on at the right fades there, until it is scrolled to its end.
for (const code of document.querySelectorAll("pre > code")) {
  const mark = () => code.parentElement.classList.toggle("cut", code.scrollWidth - code.clientWidth - code.scrollLeft > 2);
  code.addEventListener("scroll", mark, { passive: true });
  new ResizeObserver(mark).observe(code);
}
