"""The verdicts as a document that lies beside the code: the errata that are kept in generated/."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from wavesym.papers.pages.findings import (
    Findings,
    by_place,
    difference,
    lines,
    origin,
    ranges_as_corrected,
    tested,
    titles,
)
from wavesym.papers.pages.reproduction import ReproducedPage, reproduction
from wavesym.papers.record import VERDICTS, Record


def page(findings: Findings) -> str:
    """Counts, what does not hold in full, what holds in a line each, what was not judged, what survived."""
    about, (tried, turned) = findings.paper.about, findings.faults
    parts = [
        "# Errata",
        f"{about.author}, *{about.title}* ({about.english}), {about.date}. {about.transcription} Written by "
        "`wavesym verify --published --format markdown`; verdicts and evidence are computed, notes and reasons are "
        "our reading.",
        _table(("verdict", "records", "meaning"), [(name, str(n), VERDICTS[name]) for name, n in findings.counts]),
        "A case is one comparison of exact numbers that could have come out otherwise. What holds, as printed or as "
        f"corrected, was also tried with {tried} faults put in, one at a time: {turned} of them made a case fail.",
        _statistics(findings),
    ]
    if findings.errors:
        parts.append("## What does not hold as printed")
    for group in findings.errors:
        parts += [f"### {titles(group)}: {group[0].verdict}", *(_error(record, findings.reproduce) for record in group)]
    if findings.holding:
        parts.append("## What holds")
    for name, records in by_place(findings.holding).items():
        heads = ("id", "source", "printed", "range", "evidence", "faults", "compared with", "note")
        parts += [f"### {name}", _table(heads, map(_row, records))]
    if findings.edits:
        edited = [(e.record.id, _code(e.scan), _code(e.read) or "nothing", e.because) for e in findings.edits]
        parts += ["## What is read otherwise than the scan has it", _table(("id", "scan", "read as", "why"), edited)]
    if findings.unjudged:
        rows = [(lines(part.lines), _code(part.scan), part.why) for part in findings.unjudged]
        parts += ["## What was not judged, and why", _table(("source", "text", "why"), rows)]
    if findings.survivors:
        faults = [(fault.record.id, _code(fault.change), fault.because) for fault in findings.survivors]
        parts += ["## Faults that no case turns, and why", _table(("id", "fault", "why"), faults)]
    return "\n\n".join(parts) + "\n"


def _error(record: Record, reproduce: bool) -> str:
    said = [f"**{record.id}**, {record.entry.where}, {lines(record.entry.lines)} of the source", "", *_items(record)]
    if reproduce and (shown := reproduction(record)):
        said += ["", *_reproduction(shown)]
    return "\n".join(said)


def _items(record: Record) -> Iterator[str]:
    entry = record.entry
    yield f"- printed: {_with_ranges(entry.printed, entry.ranges)}"
    if entry.english:
        yield f"- in English: {_code(entry.english)}"
    if entry.inferred:
        yield f"- not printed: {', '.join(map(_code, entry.inferred))}"
    if entry.slip:
        yield f"- corrected: {_with_ranges(entry.slip.corrected, ranges_as_corrected(entry.slip, entry))}"
    if left := difference(record):
        yield f"- difference: {_code(left)}"
    yield f"- evidence: {' '.join(record.evidence)}"
    if record.note:
        yield f"- note: {record.note}"
    if origin(record):
        yield f"- origin: {origin(record)}"
    yield f"- tested: {tested(record)}"
    yield from (f"- problem: {problem}" for problem in record.problems)


def _reproduction(shown: ReproducedPage) -> Iterator[str]:
    if not shown.file:
        yield shown.said
        return
    yield from (f"Save as `{shown.file}`:", "", "```toml", shown.scene.rstrip("\n"), "```", "")
    yield from ("```sh", shown.command, "```", "", f"Look at: {shown.look}")


def _row(record: Record) -> Sequence[str]:
    entry, turned = record.entry, f"{record.mutations.turned} of {record.mutations.tried}"
    said = f"{_code(entry.printed)}, in English: {_code(entry.english)}" if entry.english else _code(entry.printed)
    ranges = ", ".join([*map(_code, entry.ranges), *(f"{_code(range_)} (not printed)" for range_ in entry.inferred)])
    source, evidence = f"{entry.where}, {lines(entry.lines)}", " ".join(record.evidence)
    return record.id, source, said, ranges, evidence, turned, record.against, record.note


def _statistics(findings: Findings) -> str:
    used = [verdict for verdict, _ in findings.counts]
    rows = [(name, *(str(counts[verdict] or "") for verdict in used)) for name, counts in findings.statistics]
    return _table(("", *used), rows)


def _table(heads: Sequence[str], rows: Iterator[Sequence[str]] | Sequence[Sequence[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def _with_ranges(formula: str, ranges: Sequence[str]) -> str:
    return ", ".join(map(_code, (formula, *ranges)))


def _code(text: str) -> str:
    return f"`{' '.join(text.split())}`" if text.strip() else ""
