"""The verdicts on a paper as pages: text, JSON, markdown, HTML and LaTeX, all from the same findings."""
