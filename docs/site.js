// code that is wider than the page is scrolled by the keyboard, too
for (const code of document.querySelectorAll("pre > code")) code.tabIndex = 0;
