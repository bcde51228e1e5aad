"""The loads of a march, from change to change whole polynomials in the time since then; all exact."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from flint import fmpq, fmpq_poly


@dataclass(frozen=True)
class LoadEvent:
    """From panel `panel` of window `window` on, load `force` is a polynomial in the time since then."""

    window: int
    panel: int
    force: int
    powers: tuple[fmpq, fmpq, fmpq]

    def times(self, factor: fmpq) -> LoadEvent:
        """The same of a load that is `factor` times as large."""
        return LoadEvent(self.window, self.panel, self.force, _three(factor * self.load))

    @property
    def load(self) -> fmpq_poly:
        """The polynomial."""
        return fmpq_poly(list(self.powers))


def load_events(gains: Mapping[tuple[fmpq, int], fmpq_poly], starts: Iterable[fmpq], step: fmpq) -> Iterator[LoadEvent]:
    """What forces are from each of their changes on, in order; `gains` has the changes by time and force.

    A window is a `step` long, and its panels have these `starts`, at which all changes are.
    """
    places = {start: number for number, start in enumerate(starts)}
    known: dict[int, tuple[fmpq, fmpq_poly]] = {}
    for (time, force), change in sorted(gains.items(), key=lambda item: item[0]):
        total = _later(known, force, time) + change
        known[force] = time, total
        window = int((time / step).floor())
        yield LoadEvent(window, places[time - window * step], force, _three(total))


def load_changes(
    events: Iterable[LoadEvent], starts: Sequence[fmpq], step: fmpq
) -> Iterator[tuple[LoadEvent, tuple[fmpq, fmpq, fmpq]]]:
    """Each event with the powers of what is new with it."""
    known: dict[int, tuple[fmpq, fmpq_poly]] = {}
    for event in events:
        time = event.window * step + starts[event.panel]
        yield event, _three(event.load - _later(known, event.force, time))
        known[event.force] = time, event.load


def _later(known: Mapping[int, tuple[fmpq, fmpq_poly]], force: int, time: fmpq) -> fmpq_poly:
    """What a force goes on as, in the time since `time`."""
    since, load = known.get(force, (time, fmpq_poly()))
    return load(fmpq_poly([time - since, 1]))


def _three(load: fmpq_poly) -> tuple[fmpq, fmpq, fmpq]:
    return load[0], load[1], load[2]
