"""A paper of a few sums, to try the pages on: small enough to see through."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from wavesym.papers.about import About, Heading, TableLayout
from wavesym.papers.entries import Aside, PaperEntry, Passage, Slip
from wavesym.papers.entries import Paper as EntriesPaper
from wavesym.papers.evaluation import Scope, holds
from wavesym.papers.mutations import mutations
from wavesym.papers.pages.findings import Findings
from wavesym.papers.record import Case, Reading, Record, Reproduction, Test, case, judge
from wavesym.papers.tree import Relation

SCENE = 'name = "counterexample"\n\n[system]\ntype = "drive"\n'
TABLE = TableLayout(
    name="Table 1",
    cell="T1.{row}.{column}",
    row_head="T1.{row}",
    columns=(Heading(key="x", formula=r"\bar{x}_{0,i}"), Heading(key="y", words="who & what")),
    rows=(Heading(key="a", formula="a"), Heading(key="b", words="b_1")),
    names={"T1.b.y": "U(x, t)"},
)
ABOUT = About(
    author="A. Łoś",
    title="Sumy & <iloczyny>",
    english="Sums",
    date="received 1979",
    transcription="Read from a scan.",
    table=(TABLE,),
)


def adding(entry: PaperEntry) -> Test:
    """Both sides of a sum, for n = 1, 2."""
    return Test("addition", _cases, faults=_faults)


def _faults(right: Reading) -> Iterator[tuple[str, Reading]]:
    """In the formula alone: that a range matters is not what is tried here."""
    for change, wrong in mutations(right.formula):
        yield change, Reading(wrong, right.ranges)


def _cases(reading: Reading) -> Iterator[Case]:
    for n in (1, 2):
        scope = Scope({"n": n})
        if all(holds(range_, scope) for range_ in reading.ranges):
            assert isinstance(reading.formula, Relation)
            left, right = reading.formula.sides
            show = (lambda: Reproduction(SCENE, "wavesym tables SCENE", "the power is 1")) if n == 1 else None
            yield case({"n": n}, lambda left=left, scope=scope: scope.value(left), scope.value(right), example=show)


def entry(id: str, printed: str, where: str, slip: Slip | None = None, **more: object) -> PaperEntry:
    given = {"scan": printed, "lines": (1, 2), **more}
    return PaperEntry(id=id, kind="sum", printed=printed, where=where, slip=slip, **given)


def _slip(corrected: str, **more: object) -> Slip:
    return Slip(**{"verdict": "misprint", "corrected": corrected, "note": "One more.", **more})


EQUIVALENT = (("sign of 0n in 0n + n", "-0 & 0 are one"), ("2 n for n in n", "0 times n is 0"))
ENTRIES = (
    entry("(1.1)", "n + 2 = 2 + n", "section 1, (1.1)"),
    entry("(1.2).1", "n + n = 3n", "section 1, (1.2)", _slip("n + n = 2n", origin="print", note="A factor.")),
    entry("T1.a.x", "n - 1 = n + 1", "Table 1, row a", _slip("n + 1 = n + 1")),
    entry("T1.a.y", "n + 1 + 1 = n + 1", "Table 1, row a", _slip("n + 1 = n + 1", note="One less.")),
    entry("T1.b.x", "0n + n = n", "Table 1, row b", ranges=("n = 1, 2",), equivalent=EQUIVALENT),
    entry("text.1", "n + n = [2", "section 1, after (1.2)", _slip("n + n = 2n", verdict="unreadable", note="#1_%")),
    entry("T1.b", "n + 1 = 1 + n", "Table 1, row b"),
)


def records(*entries: PaperEntry) -> tuple[Record, ...]:
    return tuple(judge(each, adding(each)) for each in entries or ENTRIES)


PASSAGES = (
    Passage(lines=(1, 2), where="section 1", text="x", aside=(Aside(scan="żółć Резюме $a_1$", why="names <a> & b"),)),
    Passage(lines=(4, 4), where="section 1", why="a title"),
)


class Paper:
    """Stands in for a paper's module: what `verify --published` asks of one."""

    @staticmethod
    def about() -> About:
        return ABOUT

    @staticmethod
    def paper() -> EntriesPaper:
        return EntriesPaper((PASSAGES[0].model_copy(update={"record": ENTRIES}), PASSAGES[1]), {})

    @staticmethod
    def records(
        wanted: Sequence[PaperEntry] | None = None, watch: Callable[[Sequence[PaperEntry]], Iterable[PaperEntry]] = iter
    ) -> tuple[Record, ...]:
        return tuple(judge(each, adding(each)) for each in watch(ENTRIES if wanted is None else wanted))


def findings(reproduce: bool = False) -> Findings:
    return Findings(ABOUT, records(), PASSAGES, reproduce)
