"""A paper of a few sums, to try the pages on: small enough to see through."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from wavesym.papers.entries import Paper as EntriesPaper
from wavesym.papers.entries import PaperDescription, PaperEntry, Passage, Slip, digest
from wavesym.papers.evaluation import Scope, holds
from wavesym.papers.mutations import mutations
from wavesym.papers.pages.document import Findings
from wavesym.papers.record import Case, Reading, Record, Reproduction, Test, case, judge
from wavesym.papers.tables import PrintedTable, TableHead
from wavesym.papers.tree import Relation

SCENE = 'name = "counterexample"\n\n[system]\ntype = "drive"\n'
ABOUT = PaperDescription(
    author="A. Łoś",
    title="Sumy & <iloczyny>",
    english="Sums",
    date="received 1979",
    transcription="Read from a scan.",
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


def _slip(corrected: str, note: str = "One more.", **more: object) -> dict[str, object]:
    return {"slip": {"correction": corrected, "note": note, **more}}


EQUIVALENT = (("sign of 0n in 0n + n", "-0 & 0 are one"), ("2 n for n in n", "0 times n is 0"))
PASSAGES = (
    Passage(
        lines=(1, 2),
        where="section 1, (1.2)",
        kind="sum",
        text="⟦(1.1): n + 2 = 2 + n⟧\n⟦(1.2).1: n + n = 3n⟧, ⟦[names <a> & b] żółć Резюме $a_1$⟧",
        record={
            "(1.1)": {"where": "section 1, (1.1)"},
            "(1.2).1": _slip("n + n = 2n", origin="print", note="A factor."),
        },
    ),
    Passage(
        lines=(4, 6),
        where="Table 1",
        kind="sum",
        text="\t$\\bar{x}_{0,i}$\twho & what\tU\n"
        "a\tn - 1 = n + 1\tn + 1 + 1 = n + 1\tU(x, t)\n"
        "⟦T1.b: n + 1 = 1 + n⟧\t0n + n = n\tn = n\tV(x, t)",
        record={
            "T1.a.x": _slip("n + 1 = n + 1"),
            "T1.a.y": _slip("n + 1 = n + 1", note="One less."),
            "T1.b.x": {"ranges": ("n = 1, 2",), "equivalent": EQUIVALENT},
        },
        table=(
            PrintedTable(
                name="Table 1",
                cell="T1.{row}.{column}",
                head=4,
                line=5,
                row_head="T1.{row}",
                columns=(
                    TableHead(r"$\bar{x}_{0,i}$", "x"),
                    TableHead("who & what", "y"),
                    TableHead("U", "z"),
                ),
                rows=(TableHead("a", "a"), TableHead("n + 1 = 1 + n", "b")),
                unjudged_columns={"z": "a name"},
            ),
        ),
    ),
    Passage(
        lines=(8, 8),
        where="section 1, after (1.2)",
        kind="sum",
        text="⟦text.1: n + n = [2⟧",
        record={"text.1": _slip("n + n = 2n", note="#1_%")},
    ),
    Passage(lines=(10, 10), where="section 1", why="a title"),
)
PAPER = EntriesPaper(ABOUT, PASSAGES, digest(PASSAGES))
ENTRIES = tuple(PAPER.entries.values())


def records(*entries: PaperEntry) -> tuple[Record, ...]:
    return tuple(judge(each, adding(each)) for each in entries or ENTRIES)


class Paper:
    """Stands in for a paper's module: what `verify --published` asks of one."""

    @staticmethod
    def paper() -> EntriesPaper:
        return PAPER

    @staticmethod
    def records(
        wanted: Sequence[PaperEntry] | None = None, watch: Callable[[Sequence[PaperEntry]], Iterable[PaperEntry]] = iter
    ) -> tuple[Record, ...]:
        return tuple(judge(each, adding(each)) for each in watch(ENTRIES if wanted is None else wanted))


def findings(reproduce: bool = False) -> Findings:
    return Findings(PAPER, records(), True, reproduce)
