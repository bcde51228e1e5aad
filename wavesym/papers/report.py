"""The records as text for the terminal, as JSON, and as the errata document."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from textwrap import fill
from typing import Any

from wavesym.papers.pielorz1979.building_alone import whole
from wavesym.papers.pielorz1979.claims import records
from wavesym.papers.record import VERDICTS, Claim, Record, Verdict

_SOURCE = (
    "A. Pielorz, Wykorzystanie jednowymiarowych fal w badaniach dynamicznych wybranych wielomasowych układów "
    "mechanicznych i obiektów budowlanych; formulas as transcribed from a scan, without the arguments (x, t) of U, u, "
    "theta and y, and with a sign once that is repeated where a line breaks; prose in translation; `scan` is what the "
    "scan has where it reads otherwise"
)
LARGEST_M, MOST_N = 7, 8
WIDTH = 120


def published(format: str, watch: Callable[[list[Claim[Any]]], Iterable[Claim[Any]]] = iter) -> tuple[str, bool]:
    """The verdicts as "text", "json" or "markdown", and whether everything could be tested.

    `watch` goes through the claims as they are judged.
    """
    found = records(watch)
    text = {"text": _text, "json": _json, "markdown": _markdown}[format](found)
    return text, not any(record.problems for record in found)


def _text(found: Sequence[Record]) -> str:
    width = max(len(record.id) for record in found)
    lines = [f"{record.id:{width}}  {record.verdict:10}  {record.cases:6}  {record.where}" for record in found]
    lines = [f"{'id':{width}}  {'verdict':10}  {'cases':>6}  where", *lines, ""]
    for record in found:
        if record.verdict != "holds" or record.scan:
            lines += [f"{record.id}: {record.verdict}", *_indented(record), ""]
    for verdict, count in _counts(found):
        lines.append(fill(f"{count:4} {verdict}: {VERDICTS[verdict]}", WIDTH, subsequent_indent=" " * 5))
    return "\n".join([*lines, "", _alone()]) + "\n"


def _indented(record: Record) -> Iterator[str]:
    for name, text in _details(record):
        yield fill(f"{name:10} {text}", WIDTH, initial_indent="    ", subsequent_indent=" " * 15)


def _details(record: Record) -> Iterator[tuple[str, str]]:
    yield "printed", record.printed
    if record.scan:
        yield "scan", record.scan
    if record.corrected:
        yield "corrected", record.corrected
    if record.difference:
        yield "difference", record.difference
    yield "evidence", record.evidence


def _json(found: Sequence[Record]) -> str:
    return json.dumps([_object(record) for record in found], ensure_ascii=False, indent=1) + "\n"


def _object(record: Record) -> dict[str, object]:
    wrong = record.counterexample
    return {
        "id": record.id,
        "where": record.where,
        "printed": record.printed,
        "scan": record.scan,
        "ranges": record.ranges,
        "against": record.against,
        "verdict": record.verdict,
        "corrected": record.corrected,
        "evidence": record.evidence,
        "cases": record.cases,
        "counterexample": str(wrong) if wrong else None,
        "difference": record.difference,
        "mutations": dict(record.mutations),
        "problems": list(record.problems),
    }


def _markdown(found: Sequence[Record]) -> str:
    wrong = [record for record in found if record.verdict != "holds"]
    right = [record for record in found if record.verdict == "holds"]
    parts = [
        "# Errata",
        f"{_SOURCE}. Written by `wavesym verify --published --format markdown`; every number in it is computed.",
        "\n".join(["| verdict | formulas | meaning |", "|---|---|---|"])
        + "".join(f"\n| {verdict} | {count} | {VERDICTS[verdict]} |" for verdict, count in _counts(found)),
        f"A case is one comparison of exact numbers that could have come out otherwise. {_alone()}",
        "## What does not hold as transcribed",
        *(_entry(record) for record in wrong),
        "## What holds",
        "Every formula here was also tried with faults put in (signs, factors, indices, ranges), and each fault "
        "showed.",
        "\n".join(["| id | printed | cases | faults | tested against |", "|---|---|---|---|---|", *map(_row, right)]),
    ]
    return "\n\n".join(parts) + "\n"


def _entry(record: Record) -> str:
    lines = [f"### {record.id}: {record.verdict}", "", f"{record.where}. {record.ranges}".strip(), ""]
    lines += [f"- {name}: {_code(text) if name != 'evidence' else text}" for name, text in _details(record)]
    return "\n".join(lines)


def _row(record: Record) -> str:
    printed = _code(record.printed) + (f", scan: {_code(record.scan)}" if record.scan else "")
    cells = (record.id, printed, str(record.cases), str(len(record.mutations)), record.against)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _code(text: str) -> str:
    return f"`{text}`"


def _counts(found: Iterable[Record]) -> list[tuple[Verdict, int]]:
    counts = Counter(record.verdict for record in found)
    return [(verdict, counts[verdict]) for verdict in VERDICTS if counts[verdict]]


def _alone() -> str:
    return f"The corrected list III.1 ... III.22 run by itself, from nothing, {whole(LARGEST_M, MOST_N)}."
