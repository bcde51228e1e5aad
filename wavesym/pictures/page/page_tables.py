"""The tables of a page: extremes of all outputs, and which model would have been enough."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from wavesym.documents.advice import WAVES, Advice, Candidate
from wavesym.errors import WavesymError
from wavesym.exact.contacts.events import contact_ends
from wavesym.mechanics.model import Model
from wavesym.methods.advice import advise
from wavesym.pictures.timescale import Timescale
from wavesym.programs.program import Program
from wavesym.results.presentation import group_thousands, number_text
from wavesym.results.statistics import cells, headings
from wavesym.results.summary import Summary

_DIGITS = 4  # people read no more; `summary` has them
_TOLERANCE = 0.01  # of the largest value: what an engineer would not see
_CALLED = {
    "massless": "masses on springs that weigh nothing",
    "consistent": "masses on springs with consistent mass",
    WAVES: "waves",
}


@dataclass(frozen=True)
class PageTable:
    """A table, and what to know of it; no rows where there is only something to say."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...]


def extremes_table(model: Model, found: Summary | WavesymError, scale: Timescale) -> PageTable:
    """The statistics of each output, and the largest drift, as `summary` writes them, or why they were not found."""
    if isinstance(found, WavesymError):
        return PageTable((), (), (f"Not found: {found}",))
    when = f"{scale.symbol} in {scale.unit}" if scale.unit else scale.symbol
    head = ("Output", *(text[:1].upper() + text[1:] for text in headings(f"at {when}", f" at {when}")))
    rows = (
        (
            f"{each.label}, {each.unit}" if each.unit else each.label,
            *map(group_thousands, cells(each, "\u2212", _DIGITS)),
        )
        for each in (output.readable for output in found.outputs)
    )
    short = any(not peak.reached for each in found.outputs for peak in (each.min, each.max))
    notes = [
        "After a contact has opened they are those of the formal continuation, as if it stayed closed"
        * bool(contact_ends(model)),
        _drift(found, scale),
        "The largest drift would cost too much; drifts as outputs help" * found.drifts_cost_too_much,
        *(f"{line[:1].upper()}{line[1:]}" for line in (*_links(found), *found.notes)),
        "\u2212 behind a time: the output comes up to this value, and jumps then" * short,
        f"How: {found.how}; {found.accuracy}. Four figures are shown; the command summary writes more",
    ]
    return PageTable(head, tuple(rows), tuple(filter(None, notes)))


def _links(found: Summary) -> Iterator[str]:
    return (link.describe(_DIGITS) for link in found.links or ())


def _drift(found: Summary, scale: Timescale) -> str:
    if (drift := found.largest_drift) is None:
        return ""
    value = number_text(drift.largest.value, drift.unit, _DIGITS)
    when = f"{scale.symbol} = {number_text(drift.largest.at.in_scene_time, scale.unit, _DIGITS)}"
    return f"Largest drift of a rod: {drift.label}, {value} at {when}{found.drift_accuracy}"


def advice_table(model: Model, known: Program | None) -> PageTable:
    """Which of three models is enough for each output, over the horizon of the scene; a program of it may be known."""
    try:
        found = advise(model, _TOLERANCE, known)
    except WavesymError as error:
        return PageTable((), (), (f"Not compared: {error}",))
    kept = [each for each in found.candidates if not each.refusal]
    notes = [*_verdict(found), *(f"{_CALLED[each.name]}: {each.refusal}" for each in found.candidates if each.refusal)]
    if not found.outputs:
        return PageTable((), (), tuple(notes))
    head = ("Output", *(f"{_CALLED[each.name]}, {what}" for each in kept for what in ("history", "peak")))
    labels = {probe.name: probe.label for probe in model.probes}
    rows = ((labels[name], *_differences(kept, k)) for k, (name, *_) in enumerate(found.outputs))
    notes.append(
        f"Each number is the largest difference from waves at {found.instants} instants, in parts of the output's "
        "largest value: of the history at any time, and of the peak"
    )
    return PageTable(head, tuple(rows), tuple(notes))


def _verdict(found: Advice) -> list[str]:
    if not found.outputs:
        return ["Nothing is compared with waves, as no simpler model serves"]
    if found.enough == WAVES:
        return [f"Waves are needed: no simpler model stays within {_TOLERANCE:.0%} of them in every output"]
    return [f"Enough to {_TOLERANCE:.0%} in every output: {_CALLED[found.enough]}"]


def _differences(kept: list[Candidate], output: int) -> list[str]:
    return [
        f"{value:.1e}" if value < float("inf") else "\u2013"
        for each in kept
        for value in (each.differences[output].history, each.differences[output].peak)
    ]
