"""What must hold of every chain with contacts, whatever opens and closes in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import wavesym

EXACT = 4e-16
"""A few roundings of a double."""

KINDS = st.fixed_dictionaries(
    {
        "lengths": st.tuples(*[st.sampled_from(["1", "3/2", "1.000000001", "1/2"])] * 2),
        "impedances": st.tuples(*[st.sampled_from(["1", "2", "1.001", "1/4"])] * 2),
        "mass": st.sampled_from(["1", "1/2", "4"]),
        "velocity": st.sampled_from(["1", "1/3"]),
        "strain": st.sampled_from(["0", "0", "1/5"]),
        "gap": st.sampled_from(["0", "1/4", "1e-9"]),
        "end": st.sampled_from(["free", "fixed", "absorbing"]),
    }
)
TAUS = [0.0, 0.3, 1.0, 1.7, 2.6, 3.1, 4.0]


def scaled(text: str, by: object) -> str:
    return str(Fraction(text) * Fraction(str(by)))


def touching(gap: str) -> Any:
    return {"contact": gap} if Fraction(gap) else "contact"


def line(k: Mapping[str, Any], by: int = 1, split: str = "") -> list[Any]:
    """A body with a rod strikes another rod; impedances and masses `by` times as large, the last rod in two parts."""
    first, second = (
        {"rod": length, "impedance": scaled(impedance, by)}
        for length, impedance in zip(k["lengths"], k["impedances"], strict=True)
    )
    first["velocity"], second["strain"] = k["velocity"], k["strain"]
    rest = str(Fraction(second["rod"]) - Fraction(split or 0))
    rods = [second | {"rod": split}, second | {"rod": rest}] if split else [second]
    body = {"mass": scaled(k["mass"], by), "velocity": k["velocity"], "name": "body"}
    return [body, first, touching(k["gap"]), *rods, k["end"]]


def solved(
    parts: Sequence[Any], taus: Sequence[float] = TAUS, load: Sequence[Any] = (), **outputs: Any
) -> tuple[np.ndarray, list[tuple[str, str, float]]]:
    """The outputs of a chain, and its events."""
    scene = wavesym.Scene(
        name="struck",
        system={"type": "chain", "parts": list(parts)},
        load=list(load),
        output={"until": max(taus), **outputs},
    )
    made = wavesym.evaluator(scene)
    return made(np.array(taus)), [(event.x, event.kind, event.double) for event in made.events]


def watched(k: Mapping[str, Any], parts: Sequence[Any]) -> tuple[np.ndarray, list[tuple[str, str, float]]]:
    x = Fraction(k["lengths"][0])
    return solved(parts, velocity=["body", f"{x}-", f"{x}+"], strain=[scaled(k["lengths"][0], "1/3")])


def like(found: np.ndarray, expected: np.ndarray, error: float = EXACT) -> bool:
    """Whether outputs agree, relative to the largest value of each."""
    return bool((np.abs(found - expected) <= error * np.abs(expected).max(axis=1, keepdims=True)).all())


def at_once(found: Sequence[tuple[str, str, float]], expected: Sequence[tuple[str, str, float]]) -> bool:
    """Whether the same happens at the same time, wherever it is."""
    kinds = [kind for _, kind, _ in found] == [kind for _, kind, _ in expected]
    return kinds and [tau for *_, tau in found] == pytest.approx([tau for *_, tau in expected], rel=1e-15)


@settings(max_examples=3)
@given(KINDS)
def test_a_rod_in_two_pieces_strikes_as_one(k: Mapping[str, Any]) -> None:
    (values, events), (others, same) = watched(k, line(k)), watched(k, line(k, split="1/3"))
    assert like(others, values)
    assert at_once(same, events)


@settings(max_examples=3)
@given(KINDS, st.sampled_from([3, 1000]))
def test_only_ratios_of_impedances_matter_for_contacts(k: Mapping[str, Any], by: int) -> None:
    (values, events), (others, same) = watched(k, line(k)), watched(k, line(k, by))
    assert like(others, values)
    assert at_once(same, events)


def mirrored(part: Any) -> Any:
    """The other way round, where velocities have the other sign."""
    return {**part, "velocity": scaled(part["velocity"], -1)} if isinstance(part, dict) and "velocity" in part else part


@settings(max_examples=3)
@given(KINDS)
def test_a_contact_in_a_mirror(k: Mapping[str, Any]) -> None:
    values, events = watched(k, line(k))
    length, x = sum(map(Fraction, k["lengths"])), Fraction(k["lengths"][0])
    parts = [mirrored(part) for part in reversed(line(k))]
    places = {"velocity": ["body", f"{length - x}+", f"{length - x}-"], "strain": [str(length - x / 3)]}
    others, same = solved(parts, **places)
    # outputs are in the order strain, velocity
    assert like(others * [[1], [-1], [-1], [-1]], values)
    assert at_once(same, events)
    assert {place for place, *_ in same} <= {str(length - x)}


@settings(max_examples=3)
@given(KINDS)
def test_a_contact_that_does_not_open_is_a_joint(k: Mapping[str, Any]) -> None:
    """Until it opens: taking the contact out changes nothing till then."""
    k = {**k, "gap": "0", "strain": "0"}
    events = watched(k, line(k))[1]
    until = min([4.0, *(tau for *_, tau in events)])
    taus = [until * part for part in (0.1, 0.5, 0.9, 1 - 1e-9)]
    outputs = {"velocity": ["body"], "strain": [scaled(k["lengths"][0], "1/3")], "displacement": ["body"]}
    joined = [part for part in line(k) if part != "contact"]
    assert like(solved(line(k), taus, **outputs)[0], solved(joined, taus, **outputs)[0])


@settings(max_examples=3)
@given(KINDS)
def test_a_contact_that_does_not_close_is_two_free_ends(k: Mapping[str, Any]) -> None:
    k = {**k, "gap": "100"}
    values, events = watched(k, line(k))
    assert events == []
    alone = line(k)[:2]
    x = Fraction(k["lengths"][0])
    free = solved(alone, velocity=["body", str(x)], strain=[scaled(k["lengths"][0], "1/3")])[0]
    assert like(values[:3], free)


def test_nothing_comes_back_from_an_absorbing_end_behind_a_contact() -> None:
    """The force lasts two delays of the first rod; what passed the contact is gone then, to the last bit."""
    parts = [{"rod": 1, "velocity": 1}, "contact", {"rod": "3/2"}, "absorbing"]
    taus = [0.5, 1.4, 2.4, 3.6, 5.0, 7.9]
    values, events = solved(parts, taus, strain=["2"], velocity=["2", "1/2"])
    assert events == []
    assert values[:2, [1, 2]].tolist() == [[-0.5, -0.5], [0.5, 0.5]]
    assert (values[:, 3:] == 0).all()


@pytest.mark.parametrize("gap", ["0", "1/2"])
def test_stress_that_a_contact_cannot_carry_parts_it(gap: str) -> None:
    """A pull arrives at a contact and comes back as a push, whatever is beyond; nothing passes."""
    load = [{"at": "end", "times": [0], "steps": [-1]}]
    parts = [{"joint": True, "name": "end"}, {"rod": 1}, touching(gap), {"rod": 1}, "fixed"]
    values, events = solved(parts, [0.5, 1.5, 1.9, 2.5], load, strain=["1/2", "3/2"], velocity=["1-", "1+"])
    assert events == ([] if Fraction(gap) else [("1", "opens", 1.0)])
    assert values[:, 0].tolist() == [1, 0, 0, 0]
    assert values[1].tolist() == [0] * 4
    assert values[2, 1:3].tolist() == [-2, -2]
