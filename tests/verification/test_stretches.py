"""In every stretch of time between what happens, values are compared somewhere, or it is said where they are not."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from tests.support.cornered import damped_chain, light_friction
from wavesym.exact.contacts.events import events
from wavesym.exact.reference import Reference
from wavesym.scene import Scene, lower
from wavesym.verification import integrations, programs, report
from wavesym.verification.outcome import IntegratedOutput
from wavesym.verification.reference import known_outputs
from wavesym.verification.stretches import middles, stretches, unseen_stretches


def test_stretches_are_between_what_happens_and_tenths_and_not_too_short() -> None:
    found = stretches(10.0, [0.5, 0.51, 2.0, 11.0, 0.0])
    assert found == [(0.0, 0.5), (0.51, 1.0), *pairwise(map(float, range(1, 11)))]
    taus = np.array([0.5, 0.505, 0.6, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.2, 8.4, 8.9])
    assert unseen_stretches(found, taus) == [(0.0, 0.5), (9.0, 10.0)]
    assert taus[middles(found, taus)].tolist() == [0.6, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 8.4]


def test_exact_values_are_known_between_any_two_fronts() -> None:
    known = known_outputs(lower(Scene(**damped_chain(3))))
    taus = np.array(known.taus)
    starts = sorted(known.starts)
    assert len(starts) >= 10
    for begin, end in pairwise(starts):
        assert np.any((taus > np.nextafter(begin, 9)) & (taus < np.nextafter(end, 0))) or end - begin < 1e-12


def test_values_are_compared_between_any_two_events(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first grid that told something late had nothing off fronts in 4 of 14: what was wrong there passed."""
    monkeypatch.setattr(integrations, "MOST_MOVED", integrations.MOST_MOVED / 4)
    known = known_outputs(lower(Scene(**light_friction(3))))
    found = stretches(known.until, [event.double for event in events(known.model)])
    right = integrations.midpoints(known)
    assert {outcome.verdict for outcome in right} == {"PASS"}
    for outcome in right:
        assert outcome.integral is not None
        assert unseen_stretches(found, np.array(outcome.integral.taus)) == []
    exact = Reference.values

    def wrong(begin: float, end: float, reference: Reference, taus: Sequence[float]) -> list[list[float]]:
        rows = exact(reference, taus)
        return [
            [value * (1.5 if begin < tau < end else 1) for tau, value in zip(taus, row, strict=True)] for row in rows
        ]

    for begin, end in [found[1], found[len(found) // 2], found[-1]]:
        monkeypatch.setattr(Reference, "values", lambda *given, part=(begin, end): wrong(*part, *given))
        assert "FAIL" in {outcome.verdict for outcome in integrations.midpoints(known)}, (begin, end)


def test_an_output_that_is_not_integrated_in_a_stretch_is_said_to_be_verified_in_part() -> None:
    known = known_outputs(lower(Scene(**damped_chain(3))))
    cuts = [0.0, *(event.double for event in events(known.model)), known.until]
    begin, end = max(pairwise(sorted(cuts)), key=lambda each: each[1] - each[0])
    everywhere = np.linspace(0, known.until, 4001).tolist()
    seen = IntegratedOutput(everywhere, np.ones(4001), 1e-9)
    without = [tau for tau in everywhere if not begin < tau < end]
    in_part = IntegratedOutput(without, np.ones(len(without)), 1e-9)
    count = len(known.names)
    assert report.unseen_outputs(known, [[in_part, seen]] * count) == []
    assert report.unseen_outputs(known, [[]] * count) == []  # that has a row of its own, which fails
    rows = report.unseen_outputs(known, [[seen]] * (count - 1) + [[in_part]])
    assert [(row.cells["of"], row.verdict) for row in rows] == [(known.names[-1], "-")]
    assert "verified in part" in rows[0].note


def test_instants_off_the_fronts_of_one_output_are_no_exact_ones_of_others_in_single_precision() -> None:
    """A front of another output may lie between an instant and the nearest number of single precision."""
    table = damped_chain(3)
    scene = Scene(**table)
    model = lower(scene)
    known = known_outputs(model)
    program = programs.make(model.tolerating(programs.LOOSENED[0]), programs.Request("pieces", "single"), tested=True)
    fronts = [tau for tau in known.taus if np.float32(tau) != tau]
    between = [tau + 1e-4 for tau in fronts]
    clear = IntegratedOutput([*fronts, *between], np.zeros(2 * len(fronts)), 1.0, clear=True)
    taus, given, _ = programs._instants(known, [clear], program)
    assert {*between} <= {*taus.tolist()}
    exact = np.isin(taus, known.taus)
    assert np.array_equal(taus[exact], given[exact])
