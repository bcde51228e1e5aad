"""Formulas of pages as MathML, which browsers set by themselves."""

from __future__ import annotations

import re
from html import unescape

BLOCK = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
INLINE = re.compile(r"(?<![\\$\w])\$(?! )([^$\n]+?)(?<! )\$(?![$\w])")
CODE = re.compile(r"(^```.*?^```$)", re.DOTALL | re.MULTILINE)
WORDS = re.compile(r"(?<![\\a-zA-Z{])[a-zA-Z]{3,}(?![a-zA-Z}])")


def mathml(latex: str, *, block: bool = False) -> str:
    """A formula in LaTeX as a <math> element, on a line of its own where it is a `block`."""
    from latex2mathml.converter import convert

    made = unescape(convert(latex, display="block" if block else "inline")).replace("<mo><</mo>", "<mo>&lt;</mo>")
    return made.replace('display="inline"', 'displaystyle="true"')  # fractions as large as in a line of their own


def typeset(text: str) -> str:
    """Markdown in which what stands between $ or $$ is set."""
    parts = CODE.split(text)
    for place in range(0, len(parts), 2):  # what is not code
        parts[place] = BLOCK.sub(lambda found: mathml(found[1].strip(), block=True), parts[place])
        parts[place] = INLINE.sub(lambda found: mathml(found[1]), parts[place])
    return "".join(parts)


def is_formula(code: str) -> bool:
    """Whether a span of code is a formula in LaTeX, not words or a command."""
    return WORDS.search(re.sub(r"\\(mathcal|bar|dots|text)\b", "", code)) is None
