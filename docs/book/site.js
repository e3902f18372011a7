// The button of the table of contents, which mdBook writes as the label of a box that is not shown.
document.getElementById("mdbook-sidebar-toggle")?.addEventListener("click", () => {
  document.getElementById("mdbook-sidebar-toggle-anchor").click();
});
