"""The verdicts for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import fill, indent

from wavesym.papers.pages.findings import Findings, counted, difference, lines, origin, ranges_as_corrected, tested
from wavesym.papers.pages.reproduction import ReproducedPage, reproduction
from wavesym.papers.record import VERDICTS, Record

WIDTH = 120


def page(findings: Findings) -> str:
    """Counts, a line for each record, what does not hold in full, and of the whole paper what was not judged.

    Of records that were asked for by name, all in full.
    """
    records = findings.records
    parts = ["\n".join(_counts(findings))] if findings.whole or len(records) > 1 or findings.only else []
    records = findings.shown
    parts += [_overview(records)] if findings.whole or len(records) > 1 else []
    full = [record for record in records if record.verdict != "holds" or not findings.whole]
    parts += ["\n".join(_record(record, findings.reproduce)) for record in full]
    if findings.whole:
        parts += [
            "\n".join(part)
            for part in (_statistics(findings), _edits(findings), _unjudged(findings), _survivors(findings))
            if part
        ]
    return "\n\n".join(parts) + "\n"


def _overview(records: Sequence[Record]) -> str:
    width = max(len("id"), *(len(record.id) for record in records))
    head = f"{'id':{width}}  {'verdict':10}  {'cases':>6}  where"
    rows = [f"{record.id:{width}}  {record.verdict:10}  {record.cases:6}  {record.entry.where}" for record in records]
    return "\n".join([head, *rows])


def _record(record: Record, reproduce: bool) -> Iterator[str]:
    entry = record.entry
    yield f"{record.id}: {record.verdict}, {VERDICTS[record.verdict]}"
    yield _said("where", f"{entry.where}, {lines(entry.lines)} of the source")
    yield _said("printed", entry.printed)
    yield from (_said("range", range_) for range_ in entry.ranges)
    yield from (_said("inferred", f"{range_} (not printed)") for range_ in entry.inferred)
    if entry.english:
        yield _said("English", entry.english)
    if entry.edits and not entry.english:
        yield _said("scan", " ".join(entry.scan.split()))
    yield from (_said("read", f"{before} as {after or 'nothing'}: {why}") for before, after, why in entry.edits)
    if entry.slip:
        yield _said("corrected", entry.slip.corrected)
        if entry.slip.ranges is not None:
            yield from (_said("range", range_) for range_ in ranges_as_corrected(entry.slip, entry))
    if left := difference(record):
        yield _said("difference", left)
    yield _said("evidence", " ".join(record.evidence))
    if record.note:
        yield _said("note", record.note)
    if origin(record):
        yield _said("origin", origin(record))
    yield _said("tested", tested(record))
    yield from (_said("survived", f"{change}: {because}") for change, because in record.mutations.survived)
    yield from (_said("problem", problem) for problem in record.problems)
    if reproduce and (shown := reproduction(record)):
        yield from _reproduction(shown)


def _reproduction(shown: ReproducedPage) -> Iterator[str]:
    if not shown.file:
        yield _said("reproduce", shown.said)
        return
    yield _said("reproduce", f"Save this scene as {shown.file}:")
    yield ""
    yield indent(shown.scene.rstrip("\n"), " " * 4)
    yield ""
    yield _said("then type", shown.command)
    yield _said("look at", shown.look)


def _said(name: str, text: str) -> str:
    return fill(
        f"{name:10} {text}", WIDTH, initial_indent="    ", subsequent_indent=" " * 15, break_long_words=False,
        break_on_hyphens=False,
    )  # fmt: skip


def _statistics(findings: Findings) -> Iterator[str]:
    used = [verdict for verdict, _ in findings.counts]
    width = max(len(name) for name, _ in findings.statistics)
    yield f"{'':{width}}  " + "  ".join(f"{verdict:>10}" for verdict in used)
    for name, counts in findings.statistics:
        yield f"{name:{width}}  " + "  ".join(f"{counts[verdict] or '-':>10}" for verdict in used)


def _edits(findings: Findings) -> Iterator[str]:
    if findings.edits:
        yield "Read otherwise than the scan has it:"
        for edit in findings.edits:
            said = f"{edit.record.id}: {edit.scan} as {edit.read or 'nothing'}: {edit.because}"
            yield fill(said, WIDTH, initial_indent="    ", subsequent_indent=" " * 8)


def _unjudged(findings: Findings) -> Iterator[str]:
    if findings.unjudged:
        yield "Not judged, and why:"
        width = max(len(lines(part.lines)) for part in findings.unjudged)
        for part in findings.unjudged:
            yield fill(
                f"{lines(part.lines):{width}}  {part.why}",
                WIDTH,
                initial_indent="    ",
                subsequent_indent=" " * (width + 6),
            )


def _survivors(findings: Findings) -> Iterator[str]:
    if findings.survivors:
        yield "Faults that no case turns, and why:"
        for fault in findings.survivors:
            said = f"{fault.record.id}: {fault.change}: {fault.because or 'unknown'}"
            yield fill(said, WIDTH, initial_indent="    ", subsequent_indent=" " * 8)


def _counts(findings: Findings) -> Iterator[str]:
    tried, turned = findings.faults
    for verdict, count in findings.counts:
        yield fill(f"{count:4} {verdict}: {VERDICTS[verdict]}", WIDTH, subsequent_indent=" " * 5)
    yield f"{counted(tried, 'fault')} put in, {turned} turned by a case"
