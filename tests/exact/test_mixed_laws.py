"""Two laws in one joint: which pairs are served, as the documents have it, and drawn mixes against another solver."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from flint import arb, ctx

from tests.exact.test_corner_truth import wrong
from tests.support.cornered import Mix, friction_beside_contacts, light_friction
from tests.support.judging import BITS, CLOSE, wrong_values
from tests.support.piecewise import PiecewiseChain
from tests.support.series import Unclear
from wavesym.errors import WavesymError
from wavesym.exact.contacts import course
from wavesym.exact.contacts.events import events
from wavesym.exact.contacts.schedule import GrazingError
from wavesym.scene import Scene, lower

Event = tuple[tuple[str, str], arb]
"""Where and what, and when."""

# a friction of 1/3 would end the rod's velocity exactly as its front returns: to stick then, and to slide on at no
# velocity, are one motion under two names
LAWS: dict[str, Any] = {
    "contact": "contact",
    "gap": {"spring": 4, "gap": ["-1/8", "1/4"]},
    "push": {"spring": 4, "only": "push"},
    "push, dashpot": {"spring": 4, "only": "push", "gap": "1/8", "dashpot": "1/5"},
    "yield": {"spring": 4, "yield": "1/8"},
    "friction": {"friction": "3/10"},
    "friction, dashpot": {"friction": "3/10", "dashpot": "1/5"},
    "breakaway": {"friction": "1/3", "breakaway": "1/2"},
    "spring": {"spring": 4},
    "dashpot": {"dashpot": "1/5"},
}
BESIDE, AT = ([law for law in LAWS if law != without] for without in ("breakaway", "contact"))
PAGE = Path(__file__).parents[2] / "docs" / "contacts.md"

# a contact opens and closes while what it touches sticks and slips; a joint without mass; a spring that yields there
CONTACTS = (3, 8, 14, 33, 44, 46, 4, 52, 54)
LIGHT = (2, 11, 17)


def pair(beside: str, at: str, node: dict[str, Any]) -> dict[str, Any]:
    """A rod that comes with a velocity, a law, and a node that has another one to the ground; a rod if it is light."""
    joint = [] if beside == "contact" else [{"joint": True}]
    parts = [{"rod": 1, "velocity": 1}, *joint, LAWS[beside], node | {"name": "n"} | LAWS[at]]
    parts += [{"rod": 2}] if "joint" in node else []
    output = {"until": "5/2", "tolerance": 1e-9, "velocity": ["n"], "displacement": ["n"]}
    return {"name": "pair", "system": {"type": "chain", "parts": parts}, "output": output}


NODES = {"mass": {"mass": 1, "velocity": 0}, "joint": {"joint": True}}


def documented() -> dict[tuple[str, str, str], bool]:
    """Which pairs the page says are served: by law between rod and node, law at the node, and kind of node."""
    section = PAGE.read_text(encoding="utf-8").split("## Laws in one joint")[1].split("\n## ")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in re.findall(r"^\|.*\|$", section, re.M)]
    laws = [name.strip("`") for name in rows[0][1:]]
    found = {}
    for beside, *cells in rows[2:]:
        for at, cell in zip(laws, cells, strict=True):
            served = {"yes": (True, True), "mass": (True, False), "joint": (False, True), "no": (False, False)}[cell]
            found |= {(beside.strip("`"), at, kind): each for kind, each in zip(NODES, served, strict=True)}
    return found


def refusal(table: dict[str, Any]) -> str:
    """Why a scene is refused; nothing where it is not."""
    try:
        Scene(**table)
    except WavesymError as error:
        return str(error)
    return ""


def test_pairs_of_laws_are_served_or_refused_at_once_as_the_page_says() -> None:
    said = documented()
    assert said.keys() == set(product(BESIDE, AT, NODES))
    for (beside, at, kind), served in said.items():
        begin = time.perf_counter()
        refused = refusal(pair(beside, at, NODES[kind]))
        assert time.perf_counter() - begin < 2
        assert served == (refused == ""), (beside, at, kind, refused)
        assert served or ("write" in refused and "\n" not in refused)


@pytest.mark.slow
@pytest.mark.parametrize("kind", NODES)
@pytest.mark.parametrize("beside", BESIDE)
def test_pairs_of_laws_do_as_they_should(beside: str, kind: str) -> None:
    for at in AT:
        if documented()[beside, at, kind]:
            assert wrong(pair(beside, at, NODES[kind]), first="0") == [], at


DRAWN = [(friction_beside_contacts, CONTACTS[0]), (light_friction, LIGHT[0])]
DRAWN += [*((friction_beside_contacts, seed) for seed in CONTACTS[1:]), *((light_friction, seed) for seed in LIGHT[1:])]


@pytest.mark.quick(1)
@pytest.mark.parametrize(("draw", "seed"), DRAWN)
def test_mixed_laws_do_as_they_should(draw: Mix, seed: int) -> None:
    assert wrong(draw(seed), first="0") == []


def wrong_mix(table: dict[str, Any]) -> list[str]:
    """What is not as the truth has it, but for the order of what happens at one instant.

    A spring that has yielded may hold or not, as what it holds sticks or turns: both say the same.
    """
    model = lower(Scene(**table))
    until = Fraction(model.horizon())
    made = PiecewiseChain(table, until)
    with ctx.workprec(BITS):
        last = arb(model.until) - CLOSE
        found = [((e.x.rstrip("+-"), e.kind), e.tau) for e in events(model) if 0 < e.tau < last]
        truth = [((e.place.rstrip("+-"), e.kind), arb(e.tau)) for e in made.events if arb(0) < arb(e.tau) < last]
        faults = [str(each) for each in (*_unmatched(found, truth), *_unmatched(truth, found))]
    return faults + list(wrong_values(model, made, [float(until) * part for part in (0.1234, 0.377, 0.71, 0.97)]))


def _unmatched(these: Sequence[Event], others: Sequence[Event]) -> Iterator[Event]:
    for what, tau in these:
        near = {other for other, time in others if abs(time - tau) <= CLOSE}
        if what not in near and not (near and what[1] in ("yields", "holds")):
            yield what, tau


@pytest.mark.slow
@pytest.mark.parametrize("start", range(0, 100, 20))
@pytest.mark.parametrize("draw", [friction_beside_contacts, light_friction])
def test_drawn_mixes_do_as_they_should(draw: Mix, start: int) -> None:
    refused = 0
    for seed in range(start, start + 20):
        try:
            assert wrong_mix(draw(seed)) == [], seed
        except (GrazingError, Unclear):
            refused += 1
    assert refused <= 3


def test_friction_of_a_mass_beside_a_contact_that_is_slightly_off_is_seen() -> None:
    table = friction_beside_contacts(CONTACTS[0])
    other = {"friction": "0.3333", "spring": "0.99"}
    parts = [
        {**part, **{key: other[key] for key in other if key in part}} if isinstance(part, dict) else part
        for part in table["system"]["parts"]
    ]
    assert wrong(table, table | {"system": {"type": "chain", "parts": parts}}, first="0")


QUIET = {"rod": 3}
"""Nothing comes back from its other end for long: the contact with it bears 0."""

RESTS: dict[str, list[Any]] = {
    "block": [{"mass": 1, "velocity": 1, "friction": "1/2", "name": "m"}, "contact", QUIET, "absorbing"],
    "told back": [{"mass": 1, "velocity": 1, "friction": "1/2", "name": "m"}, "contact", QUIET, "free"],
    "pulled": [QUIET, "contact", {"mass": 2, "velocity": -1, "friction": 3, "name": "m"}],
    "far": [{"mass": 1, "velocity": 1, "friction": "1/2", "name": "m"}, QUIET, "contact", QUIET, "absorbing"],
    "on a spring": [
        *["fixed", {"spring": 1}, {"mass": 1, "velocity": 1, "friction": "1/2", "name": "m"}, "contact", QUIET],
        *[{"mass": 2, "velocity": 0, "friction": "1/5"}, {"rod": 2}, "contact", {"mass": 1, "velocity": 0}],
    ],
}
"""A mass that friction stops, and a contact without force from then on, beside it or at the other end of a rod."""


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", RESTS)
def test_what_friction_has_stopped_bears_on_a_rod_with_just_0(name: str) -> None:
    output = {"until": 14, "displacement": ["m"], "velocity": ["m"]}
    table = {"name": "rest", "system": {"type": "chain", "parts": RESTS[name]}, "output": output}
    assert wrong(table) == []


def test_what_a_front_moves_on_a_rod_is_known_at_that_instant() -> None:
    """Friction had stopped the mass while it pressed on the rod: it did not turn round, nor part from it."""
    parts = [{"joint": True, "name": "s"}, {"rod": 2}, "contact", {"mass": 1, "name": "n", "friction": "1/2"}]
    parts[-1] |= {"velocity": -1}
    output = {"until": 6, "velocity": ["s", "n"], "displacement": ["s", "n"]}
    loads = [{"at": "s", "times": [0], "steps": [1]}]
    table = {"name": "front", "system": {"type": "chain", "parts": parts}, "load": loads, "output": output}
    model = lower(Scene(**table))
    sticks, slips, opens, *_ = events(model)
    assert (sticks.kind, slips.kind, opens.kind) == ("sticks", "slips", "opens")
    assert (slips.tau, opens.tau) == (2, 4)
    with ctx.workprec(BITS):
        assert abs(sticks.tau - arb(3).log()) < CLOSE
    assert list(wrong_values(model, PiecewiseChain(table, 7), [2.0, 4.0, 6.0])) == []


@pytest.mark.slow
@pytest.mark.parametrize("velocity", [-6, 6])
def test_what_leaves_rest_presses_on_a_rod_that_rests_or_parts_from_it(velocity: int) -> None:
    """The contact bears exactly 0 until the mass slips, and then less than the square of any time that is not known."""
    held = {"mass": 5, "velocity": 0, "friction": "5/7", "name": "m"}
    parts = ["absorbing", {"rod": 1}, "contact", held, {"spring": "3/5"}, {"mass": 1, "velocity": velocity}]
    output = {"until": 2, "displacement": ["m"], "velocity": ["m"]}
    table = {"name": "leaves", "system": {"type": "chain", "parts": parts}, "output": output}
    assert wrong(table, first="0") == []


@pytest.mark.slow
def test_a_spring_that_lets_go_makes_no_other_one_hold_for_no_time() -> None:
    """What releases is known less closely than contacts are: "holds" and "yields" were told within 1e-62 of it."""
    parts = [
        *[{"mass": "1/2", "name": "n0", "velocity": 1}, {"friction": "2/5"}, {"joint": True, "name": "n1"}],
        *[{"rod": "1/2"}, {"joint": True, "name": "n2"}, {"spring": 3, "yield": "3/10"}],
        *[{"mass": 1, "name": "n3", "friction": "1/3"}, {"spring": 3, "gap": [0, "1/5"]}],
        {"mass": "1/2", "name": "n4", "friction": "1/2", "velocity": 1},
    ]
    loads = [
        {"at": "n0", "times": [0, 1], "steps": ["-1/4", "1/4"]},
        {"at": "n1", "times": [0, 1], "ramps": ["1/4", "-1/2"]},
        {"at": "n3", "times": [1, 2], "ramps": [-1, 2]},
    ]
    output = {"until": 4, "velocity": ["n0", "n1", "n3", "n4"]}
    table = {"name": "lets_go", "system": {"type": "chain", "parts": parts}, "load": loads, "output": output}
    assert wrong(table, first="0") == []


@pytest.mark.slow
def test_three_masses_that_rub_between_two_contacts_come_to_rest() -> None:
    """As two of them stop, no number of bits told what the contacts bear."""
    parts = [
        *["absorbing", {"rod": 1}, "contact", {"mass": "1/3", "velocity": "5/3", "name": "m0", "friction": "3/2"}],
        {"spring": "12/5", "only": "push", "gap": "1/8"},
        {"mass": "1/4", "velocity": "-5/3", "name": "m1", "friction": "3/2"},
        {"spring": "6/5", "yield": 1},
        {"mass": "3/5", "velocity": "1/2", "name": "m2", "friction": "2/3", "dashpot": "1/4"},
        *["contact", {"rod": 1, "impedance": 3}, "absorbing"],
    ]
    loads = [
        {"at": "m2", "times": [0, 4], "steps": [1, -2]},
        {"at": 2, "times": [2, 4], "steps": [0, "1/3"], "ramps": ["-1/3", 0]},
    ]
    output = {"until": 10, "displacement": ["m0", "m1", "m2"], "velocity": ["m0", "m1", "m2"]}
    table = {"name": "three", "system": {"type": "chain", "parts": parts}, "load": loads, "output": output}
    assert wrong(table, first="0") == []


def test_springs_at_their_limits_as_a_load_turns_do_not_change_each_other_for_ever() -> None:
    """Two of them, and friction that slips, all at tau = 1."""
    parts = [
        {"mass": 1, "name": "n0", "friction": "1/2"},
        {"spring": 1, "yield": "1/2", "preload": "1/2"},
        {"mass": "1/2", "name": "n1"},
        {"spring": 2, "yield": "1/2", "preload": "1/2"},
        {"mass": "1/2", "name": "n2", "friction": "1/2"},
    ]
    loads = [
        {"at": "n0", "times": [1, 2], "ramps": [1, -2]},
        {"at": "n1", "times": ["1/2", "5/2"], "steps": ["1/4", "-1/4"]},
        {"at": "n2", "times": [0, 1], "ramps": [1, -2]},
    ]
    output = {"until": 4, "velocity": ["n0", "n1", "n2"]}
    table = {"name": "tie", "system": {"type": "chain", "parts": parts}, "load": loads, "output": output}
    assert wrong(table) == []


def test_what_changes_its_branch_for_ever_is_refused_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """No scene is known that does: here the first change is taken for the last of many."""
    monkeypatch.setattr(course, "CHATTER", 1)
    parts = [{"mass": 1, "velocity": 1, "name": "a"}, {"spring": 4, "only": "push", "gap": "1/8"}, "fixed"]
    output = {"until": "1/2", "velocity": ["a"]}
    model = lower(Scene(name="often", system={"type": "chain", "parts": parts}, output=output))
    with pytest.raises(
        GrazingError, match=r"^spring at 0: changes its branch 8 times within no time at tau = 0\.125, "
    ):
        events(model)
