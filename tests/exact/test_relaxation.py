"""What is left of a stiff joint when what decays fast has died away: against its Taylor series, and the truth."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from flint import arb, ctx, fmpq, fmpq_poly
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.exact.test_contact_truth import wrong
from tests.support.cushioned import seeded
from wavesym.exact.contacts import schedule as room
from wavesym.exact.contacts.events import contact_schedule, events
from wavesym.exact.joints.enclosure import Enclosure
from wavesym.exact.joints.joint_law import JointLaw
from wavesym.exact.joints.joint_motion import JointMotion
from wavesym.exact.joints.relaxation import Relaxation
from wavesym.scene import Scene, lower

BITS = 448
NO_MOTION = fmpq_poly()


@pytest.fixture(autouse=True)
def bits():
    with ctx.workprec(BITS):
        yield


def q(text: object) -> fmpq:
    top, _, bottom = str(text).partition("/")
    return fmpq(int(top), int(bottom or 1))


def cushion(mass: object, cap: object, spring: object, dashpot: object, impedance: object = 0) -> JointLaw:
    """A mass, a spring beside a dashpot, and a cap on a rod."""
    k, c = q(spring), q(dashpot)
    stiffness = ((k, -k), (-k, k))
    return JointLaw((q(mass), q(cap)), ((c, -c), (-c, c + q(impedance))), stiffness, (None, None))


def light(mass: object, impedance: object) -> JointLaw:
    return JointLaw((q(mass),), ((q(impedance),),), ((fmpq(0),),), (None,))


def train(masses: list[object], links: list[tuple[object, object]]) -> JointLaw:
    """Free masses with a spring beside a dashpot from each to the next."""
    size = len(masses)
    parts = [[[fmpq(0)] * size for _ in range(size)] for _ in range(2)]
    for n, link in enumerate(links):
        for matrix, each in zip(parts, link, strict=True):
            for i, j, sign in ((n, n, 1), (n + 1, n + 1, 1), (n, n + 1, -1), (n + 1, n, -1)):
                matrix[i][j] += sign * q(each)
    stiffness, damping = (tuple(tuple(row) for row in matrix) for matrix in parts)
    return JointLaw(tuple(map(q, masses)), damping, stiffness, (None,) * size)


STIFF = [
    cushion(1, 0, 200, "1/100"),
    cushion(1, 0, 200, "1/10", "1/2"),
    cushion(1, "1/1000000", 200, "1/100"),
    cushion(2, "1/10000", 50, "1/3", 1),
    light("1/100", "26/5"),
    train([1, "353/125", 2], [(5, 4), ("589/1000", 1)]),  # four rates that decay, so that powers of them are far apart
]


def moved(motion: JointMotion, forces: list[fmpq_poly], steps: int, length: fmpq) -> list[list[Enclosure]]:
    """By so many Taylor series."""
    step, found = length / steps, []
    for n in range(steps):
        acting = [
            Enclosure.from_polynomial(force(fmpq_poly([n * step, 1])) if force.length() else force) for force in forces
        ]
        found.append(motion.move(acting, [NO_MOTION] * len(forces), step, 160))
    return found


def begun(law: JointLaw, decaying: int) -> tuple[JointMotion, list[fmpq_poly]]:
    """After a shove has died away for so long that exp(-`decaying`) of it is left, and a force that goes on."""
    size = range(len(law.mass))
    forces = [fmpq_poly([n + 1, -1, fmpq(1, 3)]) for n in size]
    motion = JointMotion(law, [arb(1) for _ in size], [arb(n) / 7 for n in size], decays=True)
    time = decaying / Relaxation.separate(law)[-1].fast
    moved(motion, forces, 1 + int((time * law.fastest / 12).ceil()), time)
    return motion, [force(fmpq_poly([time, 1])) for force in forces]


@pytest.mark.quick(1)
@pytest.mark.parametrize("law", STIFF, ids=["open", "closed", "light", "light closed", "body", "train"])
@pytest.mark.parametrize("decaying", [1200, 40])
def test_the_slow_motion_encloses_what_steps_find(law: JointLaw, decaying: int) -> None:
    """Also where not all has died away: then the bound has what is left."""
    motion, forces = begun(law, decaying)
    relaxation = Relaxation.separate(law)[-1]
    length = 200 / relaxation.fast
    acting, terms = [Enclosure.from_polynomial(force) for force in forces], 100
    long = replace(motion, velocity=[*motion.velocity], displacement=[*motion.displacement])
    assert relaxation.serves(length, terms)
    series, places, missed = long.relax(relaxation, acting, [NO_MOTION] * len(forces), terms)
    long.lose(missed)
    found = long.follow(series, places, acting, length)
    steps = 40
    exact = moved(motion, forces, steps, length)
    for one, each in zip(found, zip(*exact, strict=True), strict=True):
        for n, known in enumerate(each):
            assert one.evaluate(length * n / steps).overlaps(known.evaluate(fmpq(0)))
    if decaying > 1000:
        assert max(one.error for one in found) < arb(2) ** -350
    apart = [one - other for one, other in zip(long.displacement, motion.displacement, strict=True)]
    sizes = [one - other for one, other in zip(long.velocity, motion.velocity, strict=True)]
    assert long.energy(sizes, apart).sqrt() <= long.unknown_energy.sqrt() + motion.unknown_energy.sqrt()


@settings(max_examples=9)
@given(st.sampled_from(STIFF), st.integers(0, 7), st.sampled_from(["1/1000", "1/7"]))
def test_a_series_that_is_wrong_has_a_bound_that_says_so(law: JointLaw, power: int, size: str) -> None:
    """Nothing of how it was found is taken for granted: its defect bounds its error."""
    motion, forces = begun(law, 1200)
    relaxation = Relaxation.separate(law)[-1]
    length = 200 / relaxation.fast
    acting = [Enclosure.from_polynomial(force) for force in forces]
    long = replace(motion, velocity=[*motion.velocity], displacement=[*motion.displacement])
    series, places, missed = long.relax(relaxation, acting, [NO_MOTION] * len(forces), 20)
    k = law.heavy[0]
    by = arb(q(size)) / arb(length) ** power
    series[k][power] = (series[k][power] + by).mid()
    for row, (group, ratio) in zip(places, law.moves, strict=True):
        if group == k and law.springs:
            row[power + 1] = (row[power + 1] + arb(ratio) * by / (power + 1)).mid()
    long.lose(
        missed
        + (
            long.energy([by if n == k else arb(0) for n in range(len(forces))], [arb(0)] * len(forces))
            if power == 0
            else arb(0)
        )
    )
    found = long.follow(series, places, acting, length)
    exact = moved(motion, forces, 40, length)
    for one, each in zip(found, zip(*exact, strict=True), strict=True):
        assert all(one.evaluate(length * n / 40).overlaps(known.evaluate(fmpq(0))) for n, known in enumerate(each))
    assert found[k].error > arb(q(size)) / 1000


def test_rates_are_parted_where_they_are_far_apart() -> None:
    slow, fast = (next(iter(Relaxation.separate(STIFF[0]))), Relaxation.separate(STIFF[3])[-1])
    assert (slow.slow, slow.fast) == (0, 20000)
    assert 12000 < fast.fast < 14000
    assert fast.slow * 8 < fast.fast
    # what swings long does not die away, and nothing is far from a rate alone
    assert Relaxation.separate(JointLaw((q(1),), ((q("1/100"),),), ((q(10**6),),), (None,))) == ()


# ---- cushions that lift off


def cushioned(spring: object, dashpot: object, until: str, gap: str = "1/7", **cap: Any) -> dict[str, Any]:
    """A ram with a cushion strikes a pile."""
    parts = [
        {"mass": 1, "velocity": 1},
        {"spring": spring, "dashpot": dashpot},
        cap or {"joint": True},
        {"contact": gap},
        {"rod": 1},
        "fixed",
    ]
    output = {"until": until, "velocity": ["0+"], "strain": ["1/2"]}
    return {"name": "cushion", "system": {"type": "chain", "parts": parts}, "output": output}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spring", "dashpot", "cap"), [(100, "1/8", {}), (60, "1/4", {"mass": "1/1000"})], ids=["massless", "light"]
)
def test_a_stiff_cushion_lifts_off_when_it_should(spring: int, dashpot: str, cap: dict[str, Any]) -> None:
    table = cushioned(spring, dashpot, "4.7", **cap)
    assert wrong(table) == []
    assert {event.kind for event in events(lower(Scene(**table)))} == {"opens", "closes"}


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(58))
def test_what_is_stiff_beside_contacts_moves_as_it_should(seed: int) -> None:
    """Cushions, light masses, thin layers and twins, drawn."""
    assert wrong(seeded(seed)) == []


def stretches(table: dict[str, Any]) -> int:
    model = lower(Scene(**table))
    known = contact_schedule(model, model.until)
    assert known is not None
    for number, each in known.stages.items():
        assert all(one.start < other.start for one, other in pairwise(each)), number
    return sum(map(len, known.stages.values()))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("dashpot", "cap"),
    [("1/100", {}), ("1/10000", {}), pytest.param("1/100", {"mass": "1/10000"}, marks=pytest.mark.slow)],
    ids=["stiff", "stiffer", "light"],
)
def test_what_has_died_away_cuts_no_stretches(dashpot: str, cap: dict[str, Any]) -> None:
    """Rates of 20 000 and more: cut for these, stretches would be 10 000 and more."""
    assert stretches(cushioned(200, dashpot, "6", **cap)) < 1500


def test_without_leaving_out_what_is_fast_the_same_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    model = lower(Scene(**cushioned(100, "1/8", "2.4", gap="1/7")))
    short = events(model)
    monkeypatch.setattr(Relaxation, "separate", lambda law: ())
    room.outcome.cache_clear()
    long = events(model)
    room.outcome.cache_clear()
    assert [(event.kind, event.digits) for event in short] == [(event.kind, event.digits) for event in long]
    assert long


def test_a_body_that_presses_ever_less_still_presses(thorough: bool) -> None:
    """It decays by exp(-1000 tau), far below all bits, and the contact stays closed until the wave comes back."""
    parts = [{"mass": "1/1000", "velocity": 1}, "contact", {"rod": 1}, "absorbing"]
    table = {
        "name": "light",
        "system": {"type": "chain", "parts": parts},
        "output": {"until": "3" if thorough else "1", "velocity": ["0+"]},
    }
    assert events(lower(Scene(**table))) == ()


@pytest.mark.slow
def test_more_bits_are_had_from_the_stretches_that_were_found() -> None:
    model = lower(Scene(**cushioned(200, "1/100", "2")))
    known = contact_schedule(model, model.until)
    assert known is not None
    with ctx.workprec(2 * BITS):
        anew = room.replay(model.network, known.stages, known.breakpoints, model.loads)
        for end, wave in known.waves.sent.items():
            until = known.ends[model.network.joint_of[model.network.point_at(end)]]
            for tau in (until * k / 41 for k in range(40)):
                (one, since), (other, after) = wave.locate(tau), anew.sent[end].locate(tau)
                assert one.evaluate(since).overlaps(other.evaluate(after))
                assert other.evaluate(after).rad() < arb(2) ** -330
