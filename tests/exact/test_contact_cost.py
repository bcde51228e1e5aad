"""What contacts cost is seen before it is spent: how fronts are counted, and when stretches are refused."""

from __future__ import annotations

import time
from dataclasses import replace
from heapq import heappop, heappush
from typing import Any

import numpy as np
import pytest
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.touching import FIXED, body, contact, line, q, rod
from wavesym.api import summary
from wavesym.errors import CostError, ToleranceError
from wavesym.exact.contacts import cost
from wavesym.exact.contacts.events import contact_schedule, events
from wavesym.exact.joints.fronts import front_sources, front_times
from wavesym.exact.reference import Reference
from wavesym.mechanics.travel_times import adjust_speeds
from wavesym.pictures.page import document
from wavesym.pictures.page.document import page
from wavesym.programs.making import make
from wavesym.results import summary as summaries
from wavesym.results.summary import summarise
from wavesym.scene import Scene, lower

LAYERS = ["0.0003925", "0.0018971"]


def layered(until: object, layers: list[str]) -> list[Any]:
    """A striker, a bar, two thin layers whose delays have no common measure, and a bar behind a contact."""
    thin = [rod(layers[0], "0.222"), rod(layers[1], "0.0306")]
    return line([rod("0.2", velocity=1), contact(), rod(), *thin, rod(), contact(), rod("0.2")], until)


def test_a_layered_specimen_is_refused_after_a_thousand_stretches() -> None:
    """Its fronts would make a million: every sum of multiples of two delays."""
    with pytest.raises(CostError, match=r"make 1024 stretches by tau = 1\.\d+, which would be .*e\+0[56] by"):
        events(layered("3", LAYERS))


@pytest.mark.quick(2)
def test_layers_whose_speeds_are_adjusted_as_the_refusal_says_are_served(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cost, "MOST_STAGES", 4000)
    model = layered("3", ["0.00393", "0.01897"])
    with pytest.raises(CostError, match=r'the limit is 4000 \(speed_adjustment = "0.5 %" under \[system\], a shorter'):
        events(model)
    bars = adjust_speeds(model.network.bars, fmpq(5, 1000))
    assert events(replace(model, network=replace(model.network, bars=bars)))


@pytest.mark.slow
@pytest.mark.parametrize(("until", "least"), [("2.1", 6000), ("2.17", 19000)])
def test_what_comes_near_the_limit_is_served(until: str, least: int) -> None:
    model = layered(until, LAYERS)
    known = contact_schedule(model, model.until)
    assert known is not None
    assert least < sum(map(len, known.stages.values())) <= cost.MOST_STAGES


@pytest.mark.slow
def test_layers_with_a_common_measure_are_served() -> None:
    assert events(layered("3", ["1/400", "1/200"]))


def test_fronts_that_send_nothing_back_are_not_counted_for_stretches() -> None:
    """Equal impedances in many pieces: fronts that are counted grow with the square of time, stretches do not."""
    parts = [rod("0.2", velocity=1), contact(), *(rod(length) for length in ("0.0317", "0.0411", "0.0523")), FIXED]
    assert events(line(parts, 9))


@settings(max_examples=30)
@given(st.lists(st.sampled_from(["1", "1/2", "0.7", "1.001", "1/3"]), min_size=1, max_size=4), st.integers(0, 3))
def test_fronts_meet_joints_as_they_do_in_fractions(lengths: list[str], until: int) -> None:
    network = line([rod(lengths[0], velocity=1), *(rod(length, 2) for length in lengths[1:])], until + 1).network
    last = {number: q(until) + fmpq(number, 7) for number in range(len(network.joints))}
    sources = front_sources(network, (), last)
    met: set[tuple[fmpq, int]] = set()
    coming = list(sources)
    while coming:
        time, number = heappop(coming)
        if time <= last[number] and (time, number) not in met:
            met.add((time, number))
            for end, _ in network.joints[number].ends:
                other = network.joint_of[network.point_at(network.opposite_end(end))]
                heappush(coming, (time + network.bars[end.bar].delay, other))
    assert list(front_times(network, sources, last)) == sorted(met)


def specimen(until: str) -> dict[str, Any]:
    """A striker, a bar, two thin layers and a bar with a contact, in units."""
    steel = {"A": "314.16 mm^2", "E": "200 GPa", "rho": "7800 kg/m^3"}
    parts = [
        {"rod": "200 mm", "velocity": "10 m/s", **steel},
        "contact",
        {"rod": "1 m", **steel},
        {"rod": "2 mm", "A": "200 mm^2", "E": "70 GPa", "rho": "2700 kg/m^3"},
        {"rod": "3 mm", "A": "200 mm^2", "E": "3 GPa", "rho": "1200 kg/m^3"},
        {"rod": "1 m", **steel},
        "contact",
        {"rod": "200 mm", **steel},
    ]
    return {
        "name": "specimen",
        "units": {"time": "us"},
        "system": {"type": "chain", "parts": parts},
        "output": {"until": until, "tolerance": 1e-6, "strain": ["0.7 m"]},
    }


@pytest.mark.slow
def test_a_hopkinson_specimen_in_layers_is_refused_before_it_is_computed() -> None:
    with pytest.raises(CostError, match=r"make 1024 stretches .*springs in place of thin rods help"):
        events(lower(Scene(**specimen("1000 us"))))
    assert events(lower(Scene(**specimen("250 us")))) == ()


def test_a_horizon_is_blamed_and_not_the_tolerance() -> None:
    """Pieces alone follow laws with corners: what stops them is what is said."""
    with pytest.raises(ToleranceError, match=r"^output.until: fronts and 1 openings .* the limit is 10000"):
        make(line([rod(1, velocity=1), contact(), rod(1), body(3), rod("7/5"), FIXED], 30000))


@pytest.mark.slow
def test_a_train_of_rods_whose_events_multiply_is_refused_early() -> None:
    """There are few fronts, as all delays are equal, and many openings at other instants."""
    parts = [rod(1, [1, "3/2"][k % 2], velocity=int(k == 0)) for k in range(30)]
    train = [part for one in parts for part in (one, contact())][:-1]
    with pytest.raises(CostError, match=r"make [1-9]\d{3} stretches by .* which would be"):
        events(line([*train, FIXED], 300))


def summed_fronts(until: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """When the strain at 0.7 m of the specimen changes, in tau, and what it is then; its second contact stays closed.

    Fronts go from joint to joint in doubles; those that arrive together are one. The striker releases at tau = 10.
    """
    steel, light, soft = ((a * 1e-6, (e * rho) ** 0.5, (e / rho) ** 0.5) for a, e, rho in MATERIALS)
    rods = [(0.2, steel), (1.0, steel), (0.002, light), (0.003, soft), (1.0, steel), (0.2, steel)]
    steps = [(1, 0, 0), (5, 0, 0), (0, 1, 0), (0, 0, 1), (5, 0, 0), (1, 0, 0)]  # how many of each delay
    unit = 0.2 / steel[2]
    delays = np.array([1.0, 0.002 / light[2] / unit, 0.003 / soft[2] / unit])
    impedance = [area * z for _, (area, z, _) in rods]
    coming: dict[tuple[int, int, int], dict[tuple[int, int], float]] = {(0, 0, 0): {(0, -1): -5.0, (1, 1): 5.0}}
    heap, changes = [(0.0, (0, 0, 0))], []
    while heap:
        tau, key = heappop(heap)
        for (number, way), size in coming.pop(key).items():  # a jump of velocity that leaves a joint into a rod
            if number == 1:
                changes.append((tau + 2.5, -way * size / steel[2]))
            then = tuple(int(a + b) for a, b in zip(key, steps[number], strict=True))
            at, beyond = float(np.dot(then, delays)), number + way
            if at > until:
                continue
            own, other = impedance[number], impedance[beyond] if 0 <= beyond < 6 else 0.0
            if {number, beyond} == {0, 1} and at > 10 - 1e-9:
                other = 0.0
            if then not in coming:
                heappush(heap, (at, then))
            there = coming.setdefault(then, {})
            for leaving, share in (
                ((number, -way), (own - other) / (own + other)),
                ((beyond, way), 2 * own / (own + other)),
            ):
                if other or leaving[0] == number:
                    there[leaving] = there.get(leaving, 0.0) + share * size
    changes.sort()
    return np.array([tau for tau, _ in changes]), np.cumsum([size for _, size in changes])


MATERIALS = ((314.16, 200e9, 7800), (200, 70e9, 2700), (200, 3e9, 1200))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("until", "stretches"), [("340 us", 800), pytest.param("480 us", 25_000, marks=pytest.mark.slow)]
)
def test_what_a_hopkinson_specimen_in_layers_shows_is_the_sum_of_its_fronts(until: str, stretches: int) -> None:
    """Of 26 000 stretches, whose fractions would grow to 20 000 digits."""
    scene = Scene(**specimen(until))
    model = lower(scene)
    end = float(model.until.p) / float(model.until.q)
    times, strains = summed_fronts(end)
    known = contact_schedule(model, model.until)
    assert known is not None
    assert sum(map(len, known.stages.values())) > stretches
    taus = [tau for tau in np.linspace(0, end, 997).tolist() if np.min(np.abs(times - tau)) > 1e-9]
    expected = np.concatenate([[0.0], strains])[np.searchsorted(times, taus)]
    (found,) = Reference(model).values(taus)
    assert len(taus) > 900
    assert np.max(np.abs(np.array(found) - expected)) < 1e-11 * np.max(np.abs(expected))


@pytest.mark.slow
def test_a_hopkinson_specimen_in_layers_is_compiled_to_the_end_of_its_test() -> None:
    scene = Scene(**specimen("600 us"))
    assert [event.kind for event in events(lower(scene))] == ["opens", "opens"]
    program = make(lower(scene))
    assert program.evaluator == "pieces"
    assert program.error_bound < 1e-15


@pytest.mark.slow
@pytest.mark.parametrize("until", ["400 us", "550 us", "600 us"])
def test_a_hopkinson_specimen_in_layers_has_a_summary_and_a_page(until: str) -> None:
    """Once 46 s for the summary, and no page in minutes: waves were searched for each value, and much of it twice."""
    scene = Scene(**specimen(until))
    start = time.process_time()
    text = page(scene)
    assert time.process_time() - start < 120  # a third of it where nothing else runs
    assert len(text.encode()) < 400_000
    assert "Not drawn: what happens between the places of the outputs would take too long" in text
    (found,) = summarise(lower(scene)).outputs
    assert found.arrival is not None
    assert found.arrival.in_scene_time == pytest.approx(98.742, abs=1e-3)  # 0.5 m at sqrt(E/rho)
    end = lower(scene).horizon()
    times, strains = summed_fronts(end)
    # those that arrive together are one, and those that would later are none
    strains = strains[np.append(np.diff(times) > 1e-9, True) & (times <= end)]
    assert found.max.value == pytest.approx(np.max(strains), rel=1e-9)
    assert found.min.value == pytest.approx(np.min(strains), rel=1e-9)
    assert times[0] == pytest.approx(2.5)


def test_a_page_says_that_fronts_are_too_many_to_be_drawn_along_the_chain(monkeypatch: pytest.MonkeyPatch) -> None:
    """And the largest drift, which nobody asked for, is not looked for then."""
    scene = Scene(**specimen("200 us"))
    assert summary(scene).largest_drift is not None
    monkeypatch.setattr(document, "_PIECES", 100)
    monkeypatch.setattr(summaries, "_MOST_FRONTS", 1)
    text = page(scene)
    assert "Not drawn: what happens between the places of the outputs would take too long" in text
    assert "The largest drift would cost too much" in text
    assert "history-0" in text
    assert "Largest drift" not in text


@pytest.mark.slow
def test_without_the_count_it_goes_on_to_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cost, "_GROWN", 10**9)
    monkeypatch.setattr(cost, "MOST_STAGES", 3000)
    with pytest.raises(CostError, match="make more than 3000 stretches"):
        events(layered("3", LAYERS))
