"""The verdicts for programs."""

from __future__ import annotations

import json

from wavesym.papers.pages.findings import Findings, origin, ranges_as_corrected
from wavesym.papers.pages.reproduction import reproduction
from wavesym.papers.record import Record


def page(findings: Findings) -> str:
    """A list of objects, one for each record in the order of print."""
    found = [_object(record, findings.reproduce) for record in findings.records]
    return json.dumps(found, ensure_ascii=False, indent=1) + "\n"


def _object(record: Record, reproduce: bool) -> dict[str, object]:
    entry, wrong, mutations = record.entry, record.counterexample, record.mutations
    said: dict[str, object] = {
        "id": record.id,
        "where": entry.where,
        "lines": list(entry.lines),
        "scan": entry.scan,
        "edits": [{"scan": before, "read": after, "because": why} for before, after, why in entry.edits],
        "printed": entry.printed,
        "english": entry.english or None,
        "ranges": list(entry.ranges),
        "inferred": list(entry.inferred),
        "corrected": record.corrected,
        "corrected_ranges": list(ranges_as_corrected(entry.slip, entry)) if entry.slip else None,
        "verdict": record.verdict,
        "origin": entry.slip.origin if entry.slip else None,
        "origin_meaning": origin(record) or None,
        "note": record.note,
        "against": record.against,
        "evidence": " ".join(record.evidence),
        "cases": record.cases,
        "counterexample": f"{wrong}." if wrong else None,
        "difference": record.difference,
        "mutations": {
            "tried": mutations.tried,
            "turned": mutations.turned,
            "survived": [{"change": change, "because": because} for change, because in mutations.survived],
        },
        "problems": list(record.problems),
    }
    if reproduce:
        shown = reproduction(record)
        said["reproduce"] = (
            {"file": shown.file, "scene": shown.scene, "command": shown.command, "look": shown.look, "said": shown.said}
            if shown
            else None
        )
    return said
