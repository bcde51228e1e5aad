// code and tables that are wider than the page are scrolled by the keyboard, too
for (const wide of document.querySelectorAll("pre > code, .md-typeset table")) {
  wide.tabIndex = 0;
  // the theme takes it away where nothing can hover
  new MutationObserver(() => wide.tabIndex < 0 && (wide.tabIndex = 0)).observe(wide, { attributeFilter: ["tabindex"] });
}
document.querySelector(".md-search")?.setAttribute("aria-label", "Search");
// a section whose own page leads it has a label without words
for (const section of document.querySelectorAll("nav.md-nav[aria-labelledby]"))
  if (!document.getElementById(section.getAttribute("aria-labelledby"))?.textContent.trim()) {
    section.removeAttribute("aria-labelledby");
    section.setAttribute("aria-label", section.querySelector(".md-nav__title").textContent.trim());
  }
// buttons that copy come with blocks of code as these are seen, each a landmark without a name
new MutationObserver(() => {
  for (const buttons of document.querySelectorAll(".md-code__nav:not([aria-label])"))
    buttons.setAttribute("aria-label", `Of the code ${buttons.querySelector("button")?.dataset.clipboardTarget ?? ""}`);
}).observe(document.body, { childList: true, subtree: true });
