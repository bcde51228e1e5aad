"""How fast: what bench/README.md has, each kind of rows in a file of its own, and the page that they are rows of."""
