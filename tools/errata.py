"""The errata as a page of the site: slips that change results first, the rest under filters, formulas set.

What it reads is generated/errata.md, which the tests compare with what is found now.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from html import escape
from itertools import pairwise

from tools.formulas import is_formula, mathml

MISTAKES, HOLDS, READ = "## What does not hold as printed\n", "## What holds\n", "## What is read otherwise"
ANOTHER_NUMBER = re.compile(r"what is printed gives -?[\d./e-]+; it should be -?[\d./e-]+\. ")
CODE = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
FIELD = re.compile(r"^- ([^:]+): (.*)$", re.MULTILINE)
SYMBOL = re.compile(r"\b([A-Za-z\u03ba]|kappa|gamma|tau|rho)(?:_(\([^)]*\)|\{[^}]*\}|\w+))?(\^2)?(?!\w)")
GREEK = {"kappa": "\u03ba", "gamma": "\u03b3", "tau": "\u03c4", "rho": "\u03c1"}
PRINTED = ("printed", "not printed", "in English", "corrected")
REST = ("evidence", "difference", "origin", "tested")
SENTENCE = re.compile(r"text\.|summary\.")
TITLES = {"T3.even.g.alpha1.K_1": "The highest power K_1 of g is 2 too high"}  # where a note has none
LONGEST = 100  # of a title
SIGNS = {"misprint": "✗", "unreadable": "?", "convention": "≈", "model": "≠", "depends": "±", "incomplete": "…"}
SCRIPT = """<script>
for (const box of document.querySelectorAll(".verdicts input")) box.addEventListener("change", () => {
  const shown = new Set([...document.querySelectorAll(".verdicts input:checked")].map((each) => each.value));
  const mistakes = [...document.querySelectorAll("article.mistake")];
  for (const mistake of mistakes) mistake.hidden = !shown.has(mistake.dataset.verdict);
  document.getElementById("shown").textContent = mistakes.filter((each) => !each.hidden).length;
});
</script>"""


@dataclass(frozen=True)
class Mistake:
    """Records of one verdict that are one mistake: of each its id, and the texts of its fields."""

    verdict: str
    records: tuple[tuple[str, dict[str, str]], ...]

    @property
    def title(self) -> str:
        """What is wrong, in a few words: the first sentence of the note."""
        id, fields = self.records[0]
        clauses = re.split(r"(?<=[\w)])([.;:]) ", fields.get("note", ""))
        first = "".join([*clauses[:2], " ", *clauses[2:3]]) if clauses[0] in ("Index", "Letter") else clauses[0]
        first = TITLES.get(id, first.rstrip("."))
        if re.match("As text|$", first):
            return self.where
        return first if len(first) <= LONGEST else first[:LONGEST].rsplit(" ", 1)[0] + " …"

    @property
    def where(self) -> str:
        """Where the paper has it."""
        return self.records[0][1]["where"].partition(", line")[0]

    @property
    def changes_results(self) -> bool:
        """Whether who computes by what is printed gets another number."""
        return self.verdict == "misprint" and any(
            ANOTHER_NUMBER.search(fields["evidence"]) and not SENTENCE.match(id) for id, fields in self.records
        )

    def html(self) -> str:
        """The mistake as an article."""
        more = f" and {len(self.records) - 1} more" if len(self.records) > 1 else ""
        verdict = f'<span class="verdict">{SIGNS[self.verdict]} {self.verdict}</span>'
        lines = [
            f'<article class="mistake" data-verdict="{self.verdict}" id="{escape(self.records[0][0])}">',
            f"<h3>{symbols(self.title)}</h3>",
            f'<p class="place">{escape(self.where)}{more} {verdict}</p>',
        ]
        for _, fields in self.records[:1]:
            lines += [*definitions(fields, PRINTED), f"<p>{symbols(fields.get('note', ''))}</p>"]
        for id, fields in self.records:
            shown = (*PRINTED, *REST) if id != self.records[0][0] else REST
            lines += [f"<details><summary>{escape(id)}: evidence, and how it was tested</summary>"]
            lines += [*definitions(fields, shown), "</details>"]
        return "\n".join([*lines, "</article>"])


def definitions(fields: dict[str, str], names: tuple[str, ...]) -> list[str]:
    """Fields as a list of definitions."""
    rows = [f'<dt>{name}</dt><dd tabindex="0">{formulas(fields[name])}</dd>' for name in names if name in fields]
    return ["<dl>", *rows, "</dl>"] if rows else []


def formulas(text: str) -> str:
    """Markdown of one line as HTML: spans of code that are formulas are set."""
    found, last = [], 0
    for span in CODE.finditer(text):
        code = span[1].replace(r"\|", "|")
        found += [
            symbols(text[last : span.start()]),
            mathml(code) if is_formula(code) else f"<code>{escape(code)}</code>",
        ]
        last = span.end()
    return "".join([*found, symbols(text[last:])])


def symbols(text: str) -> str:
    """A sentence as HTML, in which letters with an index, and Greek ones by name, are set."""

    def letter(found: re.Match[str]) -> str:
        name, index, square = found[1], found[2], found[3]
        if not index and not square and name not in GREEK:
            return found[0]
        sub = f"<sub>{index.strip('(){}')}</sub>" if index else ""
        return f"<i>{GREEK.get(name, name)}</i>{sub}{'<sup>2</sup>' if square else ''}"

    return SYMBOL.sub(letter, escape(text, quote=False))


def mistakes(text: str) -> list[Mistake]:
    """What does not hold, from that section of the errata."""
    groups = re.split(r"^### ", text, flags=re.MULTILINE)[1:]
    found = []
    for group in groups:
        heading, _, body = group.partition("\n")
        parts = re.split(r"^\*\*(.+)\*\*$", body, flags=re.MULTILINE)[1:]
        records = tuple((id, dict(FIELD.findall(fields))) for id, fields in list(pairwise(parts))[::2])
        found.append(Mistake(heading.rpartition(": ")[2], records))
    return found


def filters(found: list[Mistake]) -> list[str]:
    """Boxes that show and hide what has a verdict; without a script all of it is shown."""
    verdicts = list(dict.fromkeys(each.verdict for each in found))
    boxes = [
        f'<label><input type="checkbox" value="{verdict}" checked> <span class="verdict">{SIGNS[verdict]} '
        f"{verdict}</span> {sum(each.verdict == verdict for each in found)}</label>"
        for verdict in sorted(verdicts, key=list(SIGNS).index)
    ]
    count = f'<output id="shown">{len(found)}</output> of {len(found)} are shown.'
    return ['<fieldset class="verdicts"><legend>Show these verdicts</legend>', *boxes, f"<p>{count}</p>", "</fieldset>"]


def errata_page(text: str) -> str:
    """generated/errata.md as a page of the site.

    Args:
        text: the errata, as Markdown.

    Returns:
        Markdown with articles as HTML: the slips that change results, all else that does not hold, and what holds.
    """
    opening, _, rest = text.partition(MISTAKES)
    wrong, _, rest = rest.partition(HOLDS)
    right, _, lists = rest.partition(READ)
    heading, source, *counts = opening.split("\n\n")
    paper, _, method = source.partition(" Read from")
    found = mistakes(wrong)
    first = [each for each in found if each.changes_results]
    others = [each for each in found if not each.changes_results]
    right = CODE.sub(lambda span: formulas(span[0]), right)
    return "\n\n".join(
        [
            f"{heading} to Piełorz 1979",
            f'<p class="paper">{escape(paper)}</p>',
            "wavesym reads every formula of this paper as it is printed, and compares it with the derived laws. The "
            f"{len(first)} slips that change results come first: who computes by what is printed gets another number.",
            "\n".join(filters(found)),
            f"## {len(first)} slips that change results",
            *(each.html() for each in first),
            "## What else does not hold as printed",
            "Slips in ranges and sentences, what the scan has made unreadable, and what needs a convention or a "
            "hypothesis that is not printed.",
            *(each.html() for each in others),
            "## How it was read, and how many",
            f"Read from{method}",
            *counts,
            HOLDS.rstrip() + right.rstrip(),
            READ + lists,
            SCRIPT,
        ]
    )
