"""The verdicts as pages: each says all of it, in markup that its readers take."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from tests.papers.small import ENTRIES, PAPER, SCENE, entry, findings, records
from tests.pictures.browser import axe, reported
from tests.pictures.test_page import LOOK
from tests.support.tex import TexError, read_tex
from wavesym.cli import main
from wavesym.papers.pages.document import SIGNS, Cell, Findings, Table, counts, fields, statistics, word_cells
from wavesym.papers.pages.formats import (
    CHARACTERS,
    FORMATS,
    LATEX,
    TEXT,
    as_json,
    as_latex,
    column_shares,
    html,
    markdown,
    tex,
    text,
)
from wavesym.papers.pages.lines import Different, Sentence, correction, fault, formula, readable, sentence, statement
from wavesym.papers.record import VERDICTS

PAGES = FORMATS
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
VOID = {"meta", "br", "col", "hr", "img", "link", "input"}


class Elements(HTMLParser):
    """The elements of a page, all closed in their order, and its text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.found: list[tuple[str, dict[str, Any]]] = []
        self.words = ""
        self.feed(page)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words += data


@pytest.mark.parametrize("format", PAGES)
def test_every_page_has_every_record_every_reason_and_every_survivor(format: str) -> None:
    words = words_of(format, PAGES[format](findings()))
    assert all(entry.id in words for entry in ENTRIES)
    assert all(because in words for _, because in ENTRIES[5].equivalent)
    assert all(squeezed(change) in squeezed(words) for change, _ in ENTRIES[5].equivalent)
    if format != "json":
        assert all(why in words for why in ("names <a> & b", "a title"))
    assert {"holds", "misprint", "unreadable"} <= set(re.findall(r"\w+", words))


def test_what_a_text_says_of_a_record_stands_apart_from_the_word_for_it() -> None:
    ranged = replace(records()[-1], entry=entry("T1.b", "n + 1 = 1 + n", "row b", inferred_ranges=("n = 1, 2",)))
    assert "not printed n = 1, 2" in PAGES["text"](Findings(PAPER, (*records(), ranged), False))


@pytest.mark.parametrize("format", PAGES)
def test_every_page_has_the_same_facts(format: str) -> None:
    left = "(2) M"
    judged = tuple(replace(record, difference=left if record.verdict != "holds" else None) for record in records())
    own = replace(
        judged[-1],
        entry=entry("T1.b", "n + 1 = 1 + n", "Table 1, row b", note="By itself.", inferred_ranges=("n = 1, 2",)),
    )
    found = Findings(PAPER, (*judged[:-1], own), format != "text")
    words = " ".join(words_of(format, PAGES[format](found)).split())
    assert squeezed(words).count(squeezed(left)) == sum(record.verdict != "holds" for record in judged)
    assert "By itself." in words
    if format != "json":
        assert words.count("line") >= len(judged)
        assert "not printed" in words.casefold()
    for record in found.records:
        assert " ".join(record.evidence) in words
        assert f"{record.mutations.turned_count} of" in words or format == "json"


@pytest.mark.parametrize("format", PAGES)
def test_every_page_shows_the_words_that_are_printed_and_what_is_read_otherwise(format: str) -> None:
    edits = (("n++n", "n+n", "the sign stands twice"), ("=2n,", "", "a comma"))
    judged = records(
        entry("(1.3)", "n + n = 2n", "section 1, (1.3)", scan="n + + n = 2n,", edits=edits),
        entry("text.2", "Suma jest dwa razy dana.", "section 1", english="n + n = 2n"),
        entry("text.3", "Suma jest trzy razy dana.", "section 1", ENTRIES[1].slip, english="n + n = 3n"),
    )
    whole = Findings(PAPER, judged, True)
    words = words_of(format, PAGES[format](Findings(PAPER, judged) if format == "text" else whole))  # by name, in full
    edited = ("n++n", "n+n", "the sign stands twice", "a comma")
    assert all(said in words for said in ("Suma jest dwa razy dana.", "Suma jest trzy razy dana.", *edited))
    assert "nothing" in words or format == "json"
    assert all(said in text(whole) for said in edited)


def words_of(format: str, page: str) -> str:
    """What a reader of a page sees of it."""
    readers = {"html": lambda page: Elements(page).words, "latex": read_back, "fragment": read_back}
    return readers.get(format, str)(page)


def squeezed(text: str) -> str:
    """Text without blanks, with the minus sign of a keyboard."""
    return re.sub(r"\s", "", text.replace("\N{MINUS SIGN}", "-"))


def read_back(page: str) -> str:
    """The text of LaTeX, as far as these tests need it."""
    page = re.sub(r"(?<!\\)\$(\\displaystyle )?", "", page)
    for written, read in CHARACTERS.items():
        page = page.replace(read, written) if len(read) > 2 else page
    return re.sub(r"\\([#$%&_{}])", r"\1", page)


def test_json_says_it_all_to_programs() -> None:
    made = {each["id"]: each for each in json.loads(as_json(findings(reproduce=True)))}
    wrong = made["(1.2).1"]
    assert wrong["printed"] == "n + n = 3n"
    assert (wrong["corrected"], wrong["origin"], wrong["note"]) == ("n + n = 2n", "print", "A factor.")
    assert wrong["counterexample"] == "With n = 1, what is printed gives 2; it should be 3."
    assert wrong["evidence"].startswith(wrong["counterexample"])
    assert wrong["reproduce"]["file"] == "1.2.1.toml"
    right = made["T1.b.x"]
    assert (right["verdict"], right["corrected"], right["counterexample"], right["origin"]) == (
        "holds",
        None,
        None,
        None,
    )
    assert right["ranges"] == ["n = 1, 2"]
    tried, turned, survived = (right["mutations"][name] for name in ("tried", "turned", "survived"))
    assert tried == turned + len(survived)
    assert [(each["change"], each["because"]) for each in survived] == list(ENTRIES[5].equivalent)
    assert "reproduce" not in json.loads(as_json(findings()))[0]


def test_entries_that_are_one_error_stand_together() -> None:
    groups = [[record.id for record in group] for group in findings().errors]
    assert groups == [["(1.2).1"], ["T1.a.x"], ["T1.a.y"], ["text.1"]]
    same = records(ENTRIES[1], entry("(1.2).2", "2 + n = 3n", "section 1, (1.2)", ENTRIES[1].slip))
    assert len(Findings(PAPER, same).errors) == 1
    column = records(ENTRIES[3], entry("T1.b.x", "n = 2n", "Table 1, row b", ENTRIES[4].slip))
    assert len(Findings(PAPER, column).errors) == 1


def test_counts_add_up() -> None:
    made = findings()
    assert sum(count for _, count in made.counts) == len(ENTRIES)
    table = statistics(made).table
    assert table is not None
    assert [[TEXT.line(cell.line) for cell in row] for row in (table.heads, *table.rows)] == [
        ["where", "holds", "misprint", "unreadable"],
        ["Section 1", "1", "1", "1"],
        ["Table 1", "3", "2", ""],
    ]
    listed = counts(made).table
    assert listed is not None
    assert [row[0].verdict for row in listed.rows] == ["holds", "misprint", "unreadable"]
    assert made.faults[0] - made.faults[1] == 2


def test_what_could_not_be_tested_is_a_failure() -> None:
    untested = records(entry("(9)", "n + n = 3n", "section 9"))
    assert not Findings(PAPER, untested).are_complete
    assert findings().are_complete
    for page in PAGES.values():
        assert "no correction is known" in page(Findings(PAPER, untested))


def test_a_record_asked_for_by_name_is_shown_in_full_and_nothing_else() -> None:
    page = text(Findings(PAPER, records(ENTRIES[5])))
    assert page.startswith("T1.b.x: holds, right as printed\n")
    assert "range       n = 1, 2" in page
    assert "unseen      2 n for n in n, a fault that no case shows: 0 times n is 0" in page
    assert "not judged" not in page


def test_a_counterexample_can_be_run() -> None:
    found = Findings(PAPER, records(ENTRIES[1], ENTRIES[0], ENTRIES[7]), reproduce=True)
    wrong, right, unreadable = ({field.name: field for field in fields(record, found)} for record in found.records)
    assert wrong["reproduce"].listing == SCENE
    assert tomllib.loads(wrong["reproduce"].listing)["name"] == "counterexample"
    assert TEXT.line(wrong["then type"].line) == "wavesym tables 1.2.1.toml"
    assert "reproduce" not in right
    assert not unreadable["reproduce"].listing
    assert "no chain behind it" in TEXT.line(unreadable["reproduce"].line)
    for name, page in PAGES.items():
        told = page(findings(reproduce=True))
        assert "wavesym tables 1.2.1.toml" in told.replace(r"\_", "_"), name
        assert "wavesym tables 1.2.1.toml" not in page(findings()), name
    assert SCENE.replace("\n", "\n    ").replace("    \n", "\n").strip() in text(findings(reproduce=True))


def test_every_verdict_has_a_sign_and_a_colour_on_each_page() -> None:
    assert SIGNS.keys() == VERDICTS.keys()
    assert len(set(SIGNS.values())) == len(SIGNS)
    page, document = html(findings()), as_latex(findings())
    for verdict in VERDICTS:
        assert re.search(rf"^\.{verdict} {{ background", page, re.MULTILINE)
        assert rf"\definecolor{{{verdict}}}" in document


def test_html_is_one_file_that_asks_for_nothing() -> None:
    page = html(findings(reproduce=True))
    found = Elements(page).found
    assert not {tag for tag, _ in found} & {"script", "link", "img", "iframe", "object", "form"}
    assert not [attributes for _, attributes in found if "src" in attributes]
    links = [attributes["href"] for tag, attributes in found if tag == "a"]
    anchors = [attributes["id"] for _, attributes in found if "id" in attributes]
    assert len(anchors) == len(set(anchors))
    assert {link.removeprefix("#") for link in links} <= set(anchors)
    assert "url(" not in page
    assert "@import" not in page
    assert "Sumy &amp; &lt;iloczyny&gt;" in page


def test_html_marks_what_differs_and_lays_tables_out() -> None:
    page = html(findings())
    assert '<mrow class="marked"><mn>3</mn></mrow>' in page
    assert '<mrow class="marked"><mn>2</mn></mrow>' in page
    table = page[page.index('<table class="paper">') :].split("</table>")[0]
    assert len(re.findall("<tr>", table)) == 3
    assert 'class="misprint"' in table
    assert "✗ misprint" in table
    assert "<mi>U</mi>" in table
    assert re.search('<th class="holds">.*<span class="label">✓ holds</span>', table, re.DOTALL)
    assert 'href="#T1.a.x"' in table


@pytest.mark.skipif(not BROWSER, reason="no browser")
def test_a_browser_shows_the_formulas_without_a_network(tmp_path: Path) -> None:
    file = tmp_path / "errata.html"
    measure = (
        "<script>document.title = [...document.querySelectorAll('math')]"
        ".map(m => Math.round(m.getBoundingClientRect().height)).join(' ') + ' requests: '"
        " + performance.getEntriesByType('resource').length</script></body>"
    )
    file.write_text(html(findings()).replace("</body>", measure), encoding="utf-8")
    flags = ["--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}"]
    done = subprocess.run(
        [str(BROWSER), *flags, "--dump-dom", file.as_uri()], capture_output=True, text=True, check=True, timeout=120
    )
    title = re.search("<title>(.*?)</title>", done.stdout)
    assert title is not None
    heights, requests = title[1].split(" requests: ")
    assert len(heights.split()) == html(findings()).count("<math")
    assert all(int(height) > 5 for height in heights.split())
    assert requests == "0"


def test_latex_is_ascii_and_closes_what_it_opens() -> None:
    page = as_latex(findings(reproduce=True))
    assert page.isascii()
    depth = 0
    for brace in re.findall(r"(?<!\\)[{}]", re.sub(r"\\\\", "", page)):
        depth += 1 if brace == "{" else -1
        assert depth >= 0
    assert depth == 0
    opened: list[str] = []
    for kind, name in re.findall(r"\\(begin|end)\{(\w+)\}", page):
        if kind == "begin":
            opened.append(name)
        else:
            assert opened.pop() == name
    assert opened == []
    assert page.count("$") % 2 == 0


@pytest.mark.parametrize(
    ("before", "after", "why"),
    [
        ("\\text{\\textemdash{}}", "\\textemdash{}", "textemdash in a formula"),
        ("\\text{\\textemdash{}}", "—", "no ASCII"),
        ("\\_", "_", "_ in text"),
        ("\\%", "%", "% in text"),
        ("^{2}", "^{2}^{2}", "a second"),
        ("2n^{2} = 0$", "2n^{2} = 0", ""),
        ("\\begin{longtable}", "", "& outside"),
    ],
)
def test_no_sign_of_a_fragment_means_something_else_where_it_stands(before: str, after: str, why: str) -> None:
    """A dash for an empty cell stood in a formula, where TeX sets it as another letter."""
    lines = [(formula("—"), formula("2n^{2} = 0")), ("a % of a_1 & #2 < 3~ma ^ |",)]
    page = FORMATS["fragment"](findings(reproduce=True)) + "\n".join(map(LATEX.line, lines))
    read_tex(page)
    assert before in page
    with pytest.raises(TexError, match=re.escape(why)):
        read_tex(page.replace(before, after, 1))


@pytest.mark.parametrize(
    ("line", "text", "written"),
    [
        (sentence("c_f^2 of U_i"), "c_f^2 of U_i", r"$\displaystyle c_{f}^{2}$ of $\displaystyle U_{i}$"),
        (sentence(r"tau_(0,i), J_0i, \bar{v}_{i} is"), None, r"\tau_{0,i}$, $J_{0,i}$, $\bar{v}_{i}$ is"),
        (sentence("g_(3, 0)^(1,2), T1.I.tau_0, rod_2"), None, r"$g_{3,0}^{1,2}$, T1.I.tau\_0, rod\_2"),
        (sentence(r"kappa_1 = 3/7, \cdot and \geq"), None, r"$\kappa_{1}$ = 3/7, $\cdot$ and \ensuremath{\geq}"),
        (fault("2 n for n in n, in n \\geq 1"), "2 n for n in n, in n \\geq 1", "$2n$ for $n$ in $n$, in $n \\geq 1$"),
        (fault(r"( for \langle in z \in \langle 0, 1 )"), None, r"( for \ensuremath{\langle} in $z \in"),
        (fault("bodies for bodies with a rod"), None, "bodies for bodies with a rod"),
    ],
)
def test_formulas_among_words_are_set_as_formulas(line: Sentence, text: str | None, written: str) -> None:
    assert written.replace(r"\displaystyle ", "") in LATEX.line((line,)).replace(r"\displaystyle ", "").replace(
        r"$\tau", r"\tau"
    )
    assert text is None or TEXT.line((line,)) == text


def test_a_record_by_itself_has_one_heading() -> None:
    page = as_latex(findings())
    assert page.count("(1.2).1") == page.count(r"\verdict{unreadable}") == 1


def test_columns_with_branches_are_wider() -> None:
    heads = word_cells("", "a", "b")
    branches = (formula(r"\begin{cases} 1 & i = 1 \\ 0 & i = 2 \end{cases}"),)
    table = Table(heads, ((Cell(("x",)), Cell((formula("1"),)), Cell(branches)),), is_grid=True)
    assert column_shares(table) == ["0.222", "0.222", "0.555"]
    assert LATEX.line(branches).startswith(r"\fitted{\begin{cases}")


def macros(page: str) -> Iterator[str]:
    yield from re.findall(r"\\([A-Za-z]+)", re.sub(r"\\\\", " ", page))


KNOWN = """
documentclass usepackage definecolor newcommand IfFileExists begin end title author date maketitle section subsection
textcolor underline colorbox cellcolor strut rule setlength parindent parskip raggedbottom emergencystretch linewidth
tabcolsep dimexpr relax hspace medskip mbox par noindent raggedright newline tabularnewline arraybackslash hline endhead
emph texttt textbf textsf ttfamily small footnotesize displaystyle ensuremath marked markedtext verdict room
textbackslash textasciitilde textasciicircum textquotedbl textless textgreater textbar textquotesingle textasciigrave
textendash textemdash ldots quotedblbase l L k surd times langle rangle leq geq approx neq pm cdot
bar dots frac sum kappa alpha begingroup endgroup lineskip lineskiplimit normallineskip hangindent hangafter law
wavesymlabels providecommand toprule midrule bottomrule label phantomsection newcommand wavesymsection wavesymsubsection
subsubsection input foot fitted sbox ifdim wd resizebox usebox else fi text
"""


def test_latex_has_no_command_that_nobody_defines() -> None:
    assert set(macros(as_latex(findings(reproduce=True)))) <= set(KNOWN.split())


def test_a_fragment_is_the_document_without_a_preamble() -> None:
    found = findings(reproduce=True)
    whole, part = as_latex(found), FORMATS["fragment"](found)
    needs = part[: part.index(r"% headings")]
    body = part.removeprefix(needs)
    assert body.strip() in whole
    assert not {"documentclass", "usepackage", "title"} & set(macros(body))
    for package in ("amsmath", "booktabs", "longtable", "textcomp", "xcolor", "hyperref"):
        assert package in needs
        assert package in whole.partition(r"\begin{document}")[0]
    labels = re.findall(r"\\label\{\\wavesymlabels:([^}]*)\}", body)
    assert "errata:4.10_" in needs
    assert len(labels) == len(set(labels))
    assert {record.id.strip("(").replace(")", "_") for record in records()} <= set(labels)


@pytest.mark.parametrize(
    ("plain", "written"),
    [
        ("50% of a_1 & #2", r"50\% of a\_1 \& \#2"),
        (r"\frac{a}{b}~^", r"\textbackslash{}frac\{a\}\{b\}\textasciitilde{}\textasciicircum{}"),
        ("Piełorz, żółć", r"Pie\l{}orz, \.{z}\'{o}\l{}\'{c}"),
        ("wavesym --x", "wavesym -{}-x"),
        ("\N{GREEK SMALL LETTER ALPHA} ≤ 1", r"\ensuremath{\alpha} \ensuremath{\leq} 1"),
        ("Шум объёма", "Shum ob''ema".replace("'", r"\textquotesingle{}")),
        ("א", "[hebrew letter alef]"),
    ],
)
def test_text_is_escaped_in_latex(plain: str, written: str) -> None:
    assert tex(plain) == written


@pytest.mark.skipif(not shutil.which("pdflatex"), reason="no LaTeX")
@pytest.mark.parametrize("format", ["latex", "fragment"])
def test_latex_compiles(tmp_path: Path, format: str) -> None:
    page = FORMATS[format](findings(reproduce=True))
    if format == "fragment":  # twice, with labels and headings of its own, in two columns
        packages = page.split("needs ", 1)[1].split("\n", 1)[0].replace(", ", "\n")
        again = r"\newcommand{\wavesymlabels}{appendix}\newcommand{\wavesymsection}{\subsection}"
        refer = r"\hyperref[errata:1.2_.1]{(1.2).1}, \hyperref[appendix:T1.a.x]{a cell}"
        head = f"\\documentclass[twocolumn]{{article}}\n{packages}\n\\begin{{document}}\n{refer}\n"
        page = f"{head}\\onecolumn\n{page}\n{again}\n{page}\n\\twocolumn\n\\end{{document}}\n"
    (tmp_path / "errata.tex").write_text(page)
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "errata.tex"]
    for _ in range(2):  # the second knows the labels
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, errors="replace", check=False)
        assert done.returncode == 0, done.stdout[-2000:]
    assert not re.search("multiply defined|undefined", done.stdout)
    assert "invalid in math mode" not in done.stdout


def test_markdown_keeps_its_tables_whole() -> None:
    page = markdown(findings(reproduce=True))
    widths: list[int] = []
    for line in page.splitlines():
        if line.startswith("|"):
            widths.append(len(re.split(r"(?<!\\)\|", line)))
        else:
            assert len(set(widths)) <= 1
            widths = []
    assert page.count("```") % 2 == 0


@pytest.mark.parametrize(
    ("said", "read"),
    [
        (r"floors equal, \kappa_i = \kappa_1", "floors equal, κ_i = κ_1"),
        (r"i = 1, 2, \dots, m", "i = 1, 2, ..., m"),
        (r"z \in \langle 2n, m)", r"z \in ⟨ 2n, m)"),
        (r"m \geq 3, and \tau is 0", "m ≥ 3, and τ is 0"),
    ],
)
def test_letters_within_a_sentence_are_written_out(said: str, read: str) -> None:
    assert readable(said) == read


def test_sentences_are_compared_word_by_word_and_their_formulas_are_read() -> None:
    said = "There are $m + 1$ bars, four in all."
    slip = ENTRIES[1].slip.model_copy(update={"correction": "There are $m - 1$ bars, in all."})
    wrong = entry("text.2", "Cztery pręty.", "section 1", slip, english=said)
    record = records(wrong)[0]
    sides = statement(record)[0], correction(record)[0]
    one, other = ([TEXT.line((part,)) for part in side if isinstance(part, Different)] for side in sides)
    assert (one, other) == (["m + 1", "four"], ["m - 1"])
    found = Findings(PAPER, records(wrong))
    assert '<mark><span class="formula"><math displaystyle="true">' in html(found)
    assert r"\markedtext{$\displaystyle m + 1$}" in as_latex(found)


def test_passages_without_text_are_named_by_their_lines() -> None:
    assert re.search(r"^line 10, section 1 +a title$", text(findings()), re.MULTILINE)
    assert text(findings()).count("a name") == 2


@pytest.mark.slow
def test_axe_finds_nothing_on_a_page_of_records(tmp_path: Path) -> None:
    """All records at once take it too long; these have formulas, a table and prose."""
    page = tmp_path / "errata.html"
    assert main(["verify", "--published", "4.10", "T3", "text.22", "--format", "html", "-o", str(page)]) == 0
    made = page.read_text(encoding="utf-8")
    assert made.count("<math") > 50
    assert reported(made, axe() + LOOK, tmp_path) == []
    assert reported(made.replace("<main>", "").replace("</main>", ""), axe() + LOOK, tmp_path) != []
