"""Contacts in the integrations over any network and in the balances, and faults put in on purpose: they are found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from flint import fmpq

from wavesym.exact.contacts.events import events
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link, Network
from wavesym.scene import Scene, lower
from wavesym.verification.checks import invariants
from wavesym.verification.collocation import UndecidedError, integrate
from wavesym.verification.integrations import (
    CornerHistory,
    _grid,
    collocation,
    compare_events,
    corner_changes,
    midpoints,
)
from wavesym.verification.problem import Change, corner_problem, match_changes
from wavesym.verification.reference import known_outputs

MANY = 2e8


def model(parts: Sequence[Any], until: object, load: Sequence[Any] = (), **output: Sequence[Any]) -> Model:
    system = {"type": "chain", "parts": list(parts)}
    return lower(Scene(name="struck", system=system, load=list(load), output={"until": until, **output}))


def bouncing() -> Model:
    """Doyen, Ern and Piperno 2011, in the falling frame: in contact on [1, 5/3] and [11/3, 13/3]."""
    bar = {"rod": 10, "speed": 30, "impedance": 30}
    parts = [{"motion": "acceleration", "name": "ground"}, {"contact": 5}, bar]
    return model(parts, 5, [{"at": "ground", "times": [0], "steps": [10]}], displacement=["0+"])


def on_a_bar(until: object = "4.7") -> Model:
    """A mass on a fixed bar, which it leaves, strikes again and leaves."""
    parts = [{"mass": 1, "velocity": 1, "name": "body"}, "contact", {"rod": 1}, "fixed"]
    return model(parts, until, velocity=["body"], displacement=["0+"])


BOUNCES = [1, 5 / 3, 11 / 3, 13 / 3]


def test_collocation_finds_when_a_bar_bounces() -> None:
    found = integrate(corner_problem(bouncing()), 5.0, 8, 200)
    assert [change.kind for change in found.changes] == ["closes", "opens"] * 2
    assert [change.tau for change in found.changes] == pytest.approx(BOUNCES, abs=1e-12)
    fallen = 5 - 5 * np.array([0.5, 2, 3]) ** 2
    (reading,) = corner_problem(bouncing()).readings
    assert (found.evaluate(reading, [0.5, 2.0, 3.0]) + fallen).tolist() == pytest.approx(
        [3.75, 5 / 3, 40 / 9], abs=1e-12
    )


def test_the_midpoint_rule_finds_when_a_bar_bounces() -> None:
    made = _grid(bouncing()).resolve_changes(5.0, MANY)
    assert made is not None
    stepped, found = made
    assert [change.kind for change, _ in found] == ["closes", "opens"] * 2
    assert all(abs(change.tau - tau) <= slack < 0.1 for (change, slack), tau in zip(found, BOUNCES, strict=True))
    assert float(stepped.step) < 0.1


@pytest.mark.parametrize(("velocity", "impedance", "length"), [("1e-9", "1e6", 1), ("1e6", "1e-6", 1000)])
def test_units_do_not_matter(velocity: str, impedance: str, length: int) -> None:
    body = {"mass": f"{length}e{impedance[2:]}", "velocity": velocity}
    small = model([body, "contact", {"rod": length, "impedance": impedance}, "fixed"], 4 * length, velocity=["0-"])
    (change,) = integrate(corner_problem(small), 4.0 * length, 12, 200).changes
    assert change.tau / length == pytest.approx(3.06766764161830635, rel=1e-12)
    stepped = _grid(small).resolve_changes(4.0 * length, MANY)
    assert stepped is not None
    ((late, slack),) = stepped[1]
    assert abs(late.tau - change.tau) <= slack


@pytest.mark.parametrize("points", [8, 16])
def test_collocation_is_exact_where_all_is_polynomial(points: int) -> None:
    parts = [{"rod": 1, "velocity": 1}, {"contact": "1/4"}, {"rod": 2}, {"contact": "1/8"}, {"rod": 1, "impedance": 2}]
    found = integrate(corner_problem(model(parts, 6, velocity=["1/2"])), 6.0, points, 200)
    first = [(0, "closes", 0.25), (0, "opens", 4.25)]
    assert [(c.corner, c.kind, pytest.approx(c.tau, abs=1e-12)) for c in found.changes if not c.corner][:2] == first


def test_all_checks_hold_where_contacts_open_and_close() -> None:
    seen = known_outputs(on_a_bar("3.3"))
    outcomes = [*collocation(seen), *corner_changes(seen), *midpoints(seen), *invariants(seen)]
    assert [outcome for outcome in outcomes if not outcome.passed] == []
    assert {"0 opens", "momentum", "energy", "contacts"} <= {outcome.subject for outcome in outcomes}


@pytest.mark.slow
def test_what_happens_is_found_by_both_integrations() -> None:
    outcomes = corner_changes(known_outputs(on_a_bar()))
    assert [outcome.subject for outcome in outcomes] == ["0 opens", "0 closes", "0 opens"]
    assert all(outcome.passed and float(outcome.cells["fronts"]) < 1e-9 for outcome in outcomes)
    stepped = [[float(outcome.cells[key]) for key in ("midpoint", "midpoint allowed")] for outcome in outcomes]
    assert all(error < allowed < 0.2 for error, allowed in stepped)


def train() -> Model:
    """Equal bars at rest that touch, struck by one and later by another: inner contacts carry no force for long."""
    bar = {"rod": 1}
    parts = [bar | {"velocity": 1}, "contact", bar, "contact", bar, "contact", bar, "contact", bar]
    parts += [{"contact": 1}, bar | {"velocity": -1}]
    return model(parts, 12, velocity=["0", "3-", "5+"])


def test_a_contact_without_force_is_not_parted_by_nothing() -> None:
    """And what a method has besides fails."""
    outcomes = corner_changes(known_outputs(train()))
    assert all(outcome.passed and outcome.cells["tau"] != "-" for outcome in outcomes)
    struck = {"midpoint": CornerHistory([(Change(0, "opens", 8.0), 0.1)], 0.0)}
    assert [each.passed for each in compare_events("2", [], struck, 12.0)] == [False]


def test_too_many_fronts_are_refused_in_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wavesym.verification.integrations._MOST_PANELS", 3)
    seen = known_outputs(on_a_bar())
    outcomes = [*collocation(seen), *corner_changes(seen)]
    assert all(outcome.passed for outcome in outcomes)
    assert any("3 panels end at tau" in outcome.note for outcome in outcomes)
    with pytest.raises(UndecidedError):
        integrate(corner_problem(on_a_bar()), 4.7, 8, 3)


def test_solutions_are_alike_where_the_same_happens_at_each_contact() -> None:
    one = [Change(0, "opens", 1.0), Change(1, "closes", 1.0)]
    other = [Change(1, "closes", 0.75), Change(0, "opens", 1.25)]
    assert match_changes(one, other) == [(one[0], 0.25), (one[1], 0.25)]
    assert match_changes(one, one[:1]) is None
    assert match_changes(one[:1], [Change(0, "closes", 1.0)]) is None


# ---- faults

GEARED = {
    "type": "chain",
    "parts": [
        {"mass": 2, "velocity": 1, "name": "hammer"},
        "contact",
        {"rod": 1},
        {"rod": 1, "impedance": 2},
        {"mass": 1, "spring": 3, "name": "gear"},
        {"spring": 1, "dashpot": "1/4"},
        {"rod": 1},
        {"contact": "1/4"},
        "fixed",
    ],
    "branch": [{"from": "gear", "name": "a", "ratio": -2, "parts": [{"rod": 1, "impedance": "1/2"}, {"mass": 1}]}],
}


def geared() -> Model:
    output = {"until": 5, "velocity": ["hammer", "0+", "a:1"], "strain": ["1/2", "5/2"]}
    return lower(Scene(name="geared", system=GEARED, output=output))


def changed(network: Network, bar: int, **changes: Any) -> Network:
    bars = [replace(each, **changes) if number == bar else each for number, each in enumerate(network.bars)]
    return replace(network, bars=tuple(bars))


def squared(network: Network) -> Network:
    """A gear ratio squared."""
    bar = next(number for number, each in enumerate(network.bars) if each.ratios[0] != 1)
    return changed(network, bar, ratios=(network.bars[bar].ratios[0] ** 2, network.bars[bar].ratios[1]))


def swapped(network: Network) -> Network:
    """An impedance on the other side."""
    first, second = network.bars[:2]
    return changed(changed(network, 0, impedance=second.impedance), 1, impedance=first.impedance)


def relinked(network: Network, change: Callable[[Link], Link]) -> Network:
    return replace(network, links=tuple(map(change, network.links)))


def wider(network: Network) -> Network:
    """Another gap."""
    return relinked(network, lambda link: replace(link, gap=link.gap + fmpq(1, 50)) if link.gap else link)


def sticking(network: Network) -> Network:
    """A contact that pulls, too."""
    sticky = {"contact": False, "damping": fmpq(100)}
    return relinked(network, lambda link: replace(link, **sticky) if link.contact and not link.gap else link)


SLOW = [pytest.param(fault, marks=pytest.mark.slow) for fault in (swapped, wider, sticking)]


@pytest.mark.slow
@pytest.mark.parametrize("fault", [squared, *SLOW])
def test_faults_of_a_network_with_contacts_are_found(
    fault: Callable[[Network], Network], monkeypatch: pytest.MonkeyPatch
) -> None:
    right = geared()
    wrong = replace(right, network=fault(right.network))
    seen = replace(known_outputs(wrong), model=right)
    claimed = events(wrong)
    monkeypatch.setattr("wavesym.verification.integrations.events", lambda _: claimed)
    monkeypatch.setattr("wavesym.verification.integrations.Reference", lambda _: Reference(wrong))
    found = [
        check
        for check in (collocation, corner_changes, midpoints)
        if not all(outcome.passed for outcome in check(seen))
    ]
    assert {collocation, corner_changes} <= {*found}
    assert midpoints in found or fault is wider  # that comes too late for the outputs


class OneSideLate(Reference):
    """Bars from the second on feel what happens at contacts as if the gap were wider."""

    def __init__(self, model: Model) -> None:
        super().__init__(model)
        self._late = Reference(replace(model, network=wider(model.network)))

    def values(self, taus: Sequence[float]) -> list[list[float]]:
        both = zip(self.model.probes, super().values(taus), self._late.values(taus), strict=True)
        return [late if probe.rod > 1 else right for probe, right, late in both]


def test_an_event_that_is_late_on_one_side_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    parts = [{"rod": 1, "velocity": 1}, {"contact": "1/4"}, {"rod": 1, "impedance": 2}]
    right = model(parts, 2, displacement=["1-", "1+"])
    monkeypatch.setattr("wavesym.verification.reference.Reference", OneSideLate)
    monkeypatch.setattr("wavesym.verification.checks.Reference", OneSideLate)
    monkeypatch.setattr("wavesym.verification.integrations.Reference", OneSideLate)
    seen = known_outputs(right)
    assert all(outcome.passed for outcome in corner_changes(seen))
    assert [outcome.passed for outcome in collocation(seen)] == [True, False]
    for check in (midpoints, invariants):
        assert not all(outcome.passed for outcome in check(seen)), check.__name__


def test_a_gear_ratio_squared_is_out_of_balance(monkeypatch: pytest.MonkeyPatch) -> None:
    right = geared()
    seen = known_outputs(right)
    monkeypatch.setattr(
        "wavesym.verification.checks.Reference", lambda m: Reference(replace(m, network=squared(m.network)))
    )
    assert not all(outcome.passed for outcome in invariants(seen))
