"""The formats of a document: text, JSON, markdown, HTML and LaTeX, each a rendering of the same list."""

from __future__ import annotations

import json
import unicodedata
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from html import escape
from textwrap import fill, indent

from wavesym.papers.pages.document import (
    Block,
    Field,
    Findings,
    Table,
    appendices,
    describe_origin,
    document,
    fields,
    reproduction,
    statistics,
    word_cells,
)
from wavesym.papers.pages.lines import Code, Different, Formula, Inline, Line, Sentence
from wavesym.papers.pages.marks import mark
from wavesym.papers.pages.mathml import mathml
from wavesym.papers.record import VERDICTS, Record
from wavesym.papers.tree import latex
from wavesym.rendering import render
from wavesym.results.presentation import align_columns

WIDTH = 120


@dataclass(frozen=True)
class Style:
    """How a format writes the parts of a line: words, code, a formula, and what is marked as different."""

    words: Callable[[str], str] = str
    code: Callable[[str], str] = lambda text: " ".join(text.split())
    formula: Callable[[Formula], str] = lambda formula: " ".join(formula.text.split())
    mark: Callable[[str], str] = str
    sets_formulas: bool = False
    """Whether formulas among words are set as formulas."""

    def line(self, line: Line) -> str:
        """A line in this format."""
        return "".join(map(self._part, line))

    def _part(self, part: Inline) -> str:
        match part:
            case Formula():
                return self.formula(part)
            case Code(text):
                return self.code(text)
            case Different(inner):
                return self.mark(self._part(inner))
            case Sentence(plain, parts):
                return self.line(parts) if self.sets_formulas else self._part(plain)
        return self.words(part)


TEXT = Style()
"""Formulas as they stand in the data."""
MARKDOWN = Style(code=lambda text: f"`{TEXT.code(text)}`", formula=lambda formula: f"`{TEXT.formula(formula)}`")
HTML = Style(
    words=escape,
    code=lambda text: f"<code>{escape(text)}</code>",
    formula=lambda formula: f'<span class="formula">{mathml(formula.tree, formula.differing)}</span>',
    mark=lambda part: f"<mark>{part}</mark>",
    sets_formulas=True,
)
LATEX = Style(
    words=lambda text: tex(text),
    code=lambda text: rf"\texttt{{{tex(TEXT.code(text))}}}",
    formula=lambda formula: _tex_formula(formula),
    mark=lambda part: rf"\markedtext{{{part}}}",
    sets_formulas=True,
)


# text


def text(findings: Findings) -> str:
    """Counts, a line for each record, what does not hold in full, and of the whole paper what was not judged.

    Records that were requested by name are all shown in full.
    """
    shown, whole = findings.visible, findings.whole
    is_list = whole or len(findings.records) > 1
    tried, turned = findings.faults
    parts = []
    if is_list or findings.only:
        parts.append("\n".join([*_text_counts(findings), f"{tried} faults put in, {turned} turned by a case"]))
    if is_list:
        rows = tuple(word_cells(each.id, each.verdict, str(each.cases), each.entry.where) for each in shown)
        parts.append(_text_table(Table(word_cells("id", "verdict", "cases", "where"), rows)))
    for record in shown:
        if record.verdict != "holds" or not whole:
            head = f"{record.id}: {record.verdict}, {VERDICTS[record.verdict]}"
            parts.append(
                "\n".join([head, *(line for field in fields(record, findings) for line in _text_field(field))])
            )
    if whole:
        counted = statistics(findings)
        tables = [(counted.title, counted.table)]
        tables += [(section.title, block.table) for section in appendices(findings) for block in section.blocks]
        parts += [f"{title}:\n{_text_table(table)}" for title, table in tables if table]
    return "\n\n".join(parts) + "\n"


def _text_counts(findings: Findings) -> Iterator[str]:
    for name, count in findings.counts:
        yield fill(f"{count:4} {name}: {VERDICTS[name]}", WIDTH, subsequent_indent=" " * 5)


def _text_field(field: Field) -> Iterator[str]:
    for number, line in enumerate(field.lines):
        name = "range" if number and field.name in ("printed", "corrected", "in English") else field.name
        yield fill(
            f"{name:12}{TEXT.line(line)}", WIDTH, initial_indent=" " * 4, subsequent_indent=" " * 16,
            break_long_words=False, break_on_hyphens=False,
        )  # fmt: skip
    if field.listing:
        yield f"\n{indent(field.listing.rstrip(), ' ' * 4)}\n"


def _text_table(table: Table) -> str:
    """Columns as wide as their cells, the last one as wide as need be; rows that do not fit are wrapped."""
    rows = [[TEXT.line(cell.line) for cell in row] for row in (table.heads, *table.rows)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)][:-1]
    if sum(widths) > WIDTH // 2:
        lines = (": ".join(filter(None, row)) for row in rows[1:])
        return "\n".join(fill(line, WIDTH, initial_indent="    ", subsequent_indent=" " * 8) for line in lines)
    return "\n".join(align_columns(rows, left=range(len(rows[0]))))


# JSON


def as_json(findings: Findings) -> str:
    """A list of objects, one for each record in the order of print."""
    return json.dumps([_object(record, findings) for record in findings.visible], ensure_ascii=False, indent=1) + "\n"


def _object(record: Record, findings: Findings) -> dict[str, object]:
    entry, slip, mutations = record.entry, record.entry.slip, record.mutations
    row: dict[str, object] = {
        "id": record.id,
        "where": entry.where,
        "lines": list(entry.lines),
        "scan": entry.scan,
        "edits": [{"scan": before, "read": after, "because": why} for before, after, why in entry.edits],
        "printed": entry.printed,
        "english": entry.english or None,
        "ranges": list(entry.ranges),
        "inferred": list(entry.inferred_ranges),
        "corrected": record.correction,
        "corrected_ranges": list(entry.right_ranges) if slip else None,
        "verdict": record.verdict,
        "origin": slip.origin if slip else None,
        "origin_meaning": describe_origin(record),
        "note": record.note,
        "against": record.reference,
        "evidence": " ".join(record.evidence),
        "cases": record.cases,
        "counterexample": f"{record.counterexample}." if record.counterexample else None,
        "difference": record.difference,
        "mutations": {
            "tried": mutations.count,
            "turned": mutations.turned_count,
            "survived": [{"change": change, "because": because} for change, because in mutations.survivors],
        },
        "problems": list(record.problems),
    }
    if findings.reproduce:
        row["reproduce"] = reproduction(record)
    return row


# markdown


def markdown(findings: Findings) -> str:
    """A document that lies beside the code: the errata that are kept in generated/."""
    page = document(findings, "markdown")
    parts = ["# Errata", f"{MARKDOWN.line(page.source)} {page.introduction}"]
    for section in page.sections:
        parts += [f"## {section.title}"] * bool(section.title)
        for block in section.blocks:
            parts += _markdown_block(block)
    return "\n\n".join(parts) + "\n"


def _markdown_block(block: Block) -> Iterator[str]:
    if block.title:
        yield f"### {block.title}{f': {block.verdict}' if block.verdict else ''}"
    if block.text:
        yield block.text
    if block.table:
        heads, *rows = ([MARKDOWN.line(cell.line) for cell in row] for row in (block.table.heads, *block.table.rows))
        lines = [heads, ["---"] * len(heads), *rows]
        yield "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)
    for entry in block.entries:
        yield f"**{entry.id}**"
        yield "\n".join(f"- {field.name}: {MARKDOWN.line(field.line)}" for field in entry.fields)
        yield from (f"```toml\n{field.listing.rstrip()}\n```" for field in entry.fields if field.listing)


# HTML and LaTeX


def html(findings: Findings) -> str:
    """One file: MathML, no script, nothing from the network. WavesymError without the library that writes MathML."""
    return render("papers/errata.html.j2", document=document(findings, "html"), line=HTML.line)


def _of_latex(findings: Findings) -> dict[str, object]:
    return {"document": document(findings, "latex"), "line": LATEX.line, "tex": tex, "shares": column_shares}


def _tex_formula(formula: Formula) -> str:
    """A formula in a line; one with branches, which no line breaks, is made as narrow as its column."""
    written = mark([latex(formula.tree)], formula.differing)[0].replace(EM_DASH, rf"\text{{{CHARACTERS[EM_DASH]}}}")
    return rf"\fitted{{{written}}}" if BRANCHES in written else rf"$\displaystyle {written}$"


def column_shares(table: Table) -> list[str]:
    """The shares of the columns in a line: where none are given the same, more for those that have branches."""
    columns = list(zip(table.heads, *table.rows, strict=True))
    weights = table.widths or [
        _BRANCHED if any(BRANCHES in TEXT.line(cell.line) for cell in column) else 1 for column in columns
    ]
    return [f"{int(1000 * weight / sum(weights)) / 1000:g}" for weight in weights]


def as_latex(findings: Findings) -> str:
    """An appendix that can be cited, for pdfLaTeX and LuaLaTeX; pure ASCII."""
    return render("papers/errata.tex.j2", **_of_latex(findings))


def as_fragment(findings: Findings) -> str:
    """The same without a preamble, to be \\input; records have labels."""
    return render("papers/errata_fragment.tex.j2", **_of_latex(findings))


EM_DASH = "—"
BRANCHES = r"\begin{cases}"
_BRANCHED = 2.5
"""How much wider a column with branches is than others."""

CHARACTERS: Mapping[str, str] = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    '"': r"\textquotedbl{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    "'": r"\textquotesingle{}",
    "`": r"\textasciigrave{}",
    **{character: f"\\{character}" for character in "#$%&_{}"},
    "ł": r"\l{}",
    "Ł": r"\L{}",
    "\N{EN DASH}": r"\textendash{}",
    EM_DASH: r"\textemdash{}",
    "…": r"\ldots{}",
    "“": "``",
    "”": "''",
    "„": r"\quotedblbase{}",
    "⟨": r"\ensuremath{\langle}",
    "⟩": r"\ensuremath{\rangle}",
    "≤": r"\ensuremath{\leq}",
    "≥": r"\ensuremath{\geq}",
    "≈": r"\ensuremath{\approx}",
    "≠": r"\ensuremath{\neq}",
    "±": r"\ensuremath{\pm}",
    "\N{MULTIPLICATION SIGN}": r"\ensuremath{\times}",
    "·": r"\ensuremath{\cdot}",
    "\N{MINUS SIGN}": r"\ensuremath{-}",
}
"""What LaTeX would read as commands, and what is no ASCII."""
_RUSSIAN = {
    **dict(zip("абвгдеёзийклмнопрстуфыэ", "abvgdeeziiklmnoprstufye", strict=True)),
    "ж": "zh",
    "\N{CYRILLIC SMALL LETTER HA}": "kh",
    "ц": "ts",
    "ч": "ch",
    "ш": "sh",
    "щ": "shch",
    "ъ": "''",
    "ь": "'",
    "ю": "yu",
    "я": "ya",
}
"""As it is transliterated: what LaTeX needs for Cyrillic is not everywhere."""
_ACCENTS = {"\u0301": "'", "\u0300": "`", "\u0307": ".", "\u0328": "k", "\u0308": '"', "\u0302": "^", "\u030c": "v"}


def tex(text: str) -> str:
    """Text as LaTeX sets it: what it would read as commands is written out, and so is what is no ASCII."""
    return "".join(map(_character, unicodedata.normalize("NFC", text))).replace("--", "-{}-")


def _character(character: str) -> str:
    if character in CHARACTERS:
        return CHARACTERS[character]
    if character.isascii():
        return character
    if character.lower() in _RUSSIAN:
        latin = _RUSSIAN[character.lower()].replace("'", CHARACTERS["'"])
        return latin if character.islower() else latin.capitalize()
    parts = unicodedata.normalize("NFD", character)
    if len(parts) == 2 and parts[0].isascii() and parts[1] in _ACCENTS:
        return f"\\{_ACCENTS[parts[1]]}{{{parts[0]}}}"
    name = unicodedata.name(character, f"U+{ord(character):04X}")
    greek = name.removeprefix("GREEK SMALL LETTER ").lower()
    return rf"\ensuremath{{\{greek}}}" if name.startswith("GREEK SMALL LETTER ") else f"[{name.lower()}]"


FORMATS: Mapping[str, Callable[[Findings], str]] = {
    "text": text,
    "json": as_json,
    "markdown": markdown,
    "html": html,
    "latex": as_latex,
    "fragment": as_fragment,
}
