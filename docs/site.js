// code and tables that are wider than the page are scrolled by the keyboard, too
for (const wide of document.querySelectorAll("pre > code, .md-typeset table")) wide.tabIndex = 0;
document.querySelector(".md-search")?.setAttribute("aria-label", "Search");
