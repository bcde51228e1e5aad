"""examples/: each scene has a picture and words, and what is said of it follows from something else, too."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import pairwise
from math import comb, exp, factorial
from pathlib import Path

import numpy as np
import pytest

import wavesym
from wavesym.pictures.field import Field
from wavesym.scene import Scene, builtin_text, lower

FOLDER = Path(wavesym.__file__).parents[1] / "examples" / "chains"
SCENES = sorted(path.stem for path in FOLDER.glob("*.toml"))
LARGEST_PICTURE = 250_000  # bytes


def example(name: str) -> Scene:
    return Scene.from_toml(FOLDER / f"{name}.toml")


def test_they_are_all_there() -> None:
    assert len(SCENES) == 7
    text = (FOLDER / "README.md").read_text(encoding="utf-8")
    for name in SCENES:
        assert example(name).name.lower() == name  # Hopkinson keeps his capital
        assert f"({name}.toml)" in text
        assert f"({name}.png)" in text
        assert (FOLDER / f"{name}.png").stat().st_size < LARGEST_PICTURE
    assert {path.stem for path in FOLDER.iterdir()} == {*SCENES, "README"}


@pytest.mark.parametrize(
    ("name", "builtin"),
    [
        ("stepped_shaft_with_dashpot", "stepped_shaft"),
        ("building_with_dampers", "damped_building"),
        ("geared_branched_drive", "geared_drive"),
    ],
)
def test_three_of_them_are_built_in(name: str, builtin: str) -> None:
    text = (FOLDER / f"{name}.toml").read_text(encoding="utf-8")
    assert text.replace(f'"{name}"', f'"{builtin}"') == builtin_text(builtin)


def test_the_mass_leaves_the_bar_when_the_series_of_its_force_says_so() -> None:
    """The force of a rigid mass on a fixed bar as a sum over reflections, with Laguerre polynomials."""
    alpha = 2 / 7  # the bar's mass over that of the hammer

    def laguerre(k: int, x: float) -> float:
        return sum(comb(k, n) * (-x) ** n / factorial(n) for n in range(k + 1))

    def p(tau: float) -> float:
        arrived = [tau - 2 * k for k in range(int(tau // 2) + 1)] if tau >= 0 else []
        return sum(exp(-alpha * w) * laguerre(k, 2 * alpha * w) for k, w in enumerate(arrived))

    response = wavesym.evaluator(example("mass_on_fixed_bar"))
    first = response.events[0]
    assert (first.x, first.kind) == ("0", "opens")
    low, high = first.double - 1e-9, first.double + 1e-9
    assert p(low) + p(low - 2) > 0 > p(high) + p(high - 2)
    taus = np.array([0.5, 1.7, 2.4, 3.9, 5.5, first.double])
    struck, fixed, hammer, _ = response(taus)
    assert struck[:-1] == pytest.approx([-p(tau) - p(tau - 2) for tau in taus[:-1]], abs=1e-12)
    assert fixed == pytest.approx([-2 * p(tau - 1) for tau in taus], abs=1e-12)
    assert hammer == pytest.approx([p(tau) - p(tau - 2) for tau in taus], abs=1e-12)
    assert [event.kind for event in response.events] == ["opens", "closes", "opens"][: len(response.events)]


def test_the_specimen_lets_through_what_a_geometric_series_says() -> None:
    response = wavesym.evaluator(example("split_hopkinson_bar"))
    reflected = (1 - 1 / 4) / (1 + 1 / 4)
    first = 5 + 1 / 2 + 5 / 2  # from the struck end to the gauge
    steps = [-(1 - reflected ** (2 * n)) / 2 for n in range(5)]
    assert response([first - 0.5 + n for n in range(5)])[1] == pytest.approx(steps, abs=1e-15)
    assert [(event.x, event.kind, event.double) for event in response.events] == [("2", "opens", 10.0)]


def test_the_brake_turns_as_the_factors_of_the_steps_say() -> None:
    disc, brake = wavesym.evaluator(example("stepped_shaft_with_dashpot"))([0.5, 3.5])[-2:]
    assert disc[0] == pytest.approx(1 - exp(-0.5), rel=1e-15)
    assert brake[1] == pytest.approx(2 / 5 * 32 / 17 * 4 / 3 * disc[0], rel=1e-15)


def test_dampers_take_energy_and_gears_turn_as_they_are_cut() -> None:
    damped = example("building_with_dampers")
    bare = damped.with_({f"system.parts[{k}].dashpot": 0 for k in (1, 3, 5)})
    taus = np.linspace(9, 12, 101)
    one, other = (np.abs(wavesym.evaluator(each)(taus)[:2]).max(axis=1) for each in (damped, bare))
    assert np.all(one < other)
    geared = example("geared_branched_drive").with_({"output.velocity": ["gears", "fan:0"], "output.strain": []})
    gears, fan = wavesym.evaluator(geared)([2.0, 5.0, 11.0])
    assert (fan == -2 * gears).all()


def test_the_train_loses_no_energy() -> None:
    """What the bars hold at the end, on many places that no front meets, is what they came with."""
    model = lower(example("bouncing_train"))
    field, part = Field(model), (np.arange(2000) + 0.4142) / 2000
    held = 0.0
    for number, bar in enumerate(model.network.bars):
        velocity, force = field.values_at(number, part, np.full_like(part, 29.9))
        held += float(bar.length) * np.mean(float(bar.impedance) * velocity**2 + force**2 / float(bar.impedance)) / 2
    assert held == pytest.approx((1 + 1 / 4) / 2, rel=2e-3)


@pytest.mark.parametrize(("name", "until", "least"), [("bouncing_train", 30, 20), ("pile_with_ram_and_cushion", 12, 2)])
def test_contacts_open_and_close_in_turn(name: str, until: int, least: int) -> None:
    scene = example(name).with_({"output.until": until})
    events = wavesym.evaluator(scene).events
    assert len(events) >= least
    assert all(one.double <= other.double for one, other in pairwise(events))
    for x in {event.x for event in events}:
        kinds = [event.kind for event in events if event.x == x]
        assert all(one != other for one, other in pairwise(kinds))


def test_the_fractions_in_the_words() -> None:
    text = " ".join((FOLDER / "README.md").read_text(encoding="utf-8").split())
    reflected = (1 - Fraction(1, 4)) / (1 + Fraction(1, 4))
    first, second, third = (1 - reflected ** (2 * n) for n in (1, 2, 3))
    assert f"= {reflected} of what arrives" in text
    assert f"{first}, then {second}, then {third}." in text
    shaft = [Fraction(1), Fraction(4), Fraction(1, 4)]
    one, other = (2 * left / (left + right) for left, right in pairwise(shaft))
    brake = 2 * shaft[-1] / (shaft[-1] + Fraction(1, 8))
    assert f"here {one} and {other}, and moves a brake of dashpot c with 2 Z/(Z + c), here {brake}." in text
    assert f"the brake turns {one * other * brake} times as fast" in text


def test_commands_of_the_documents_name_these_scenes() -> None:
    text = (FOLDER / "README.md").read_text(encoding="utf-8")
    used = set(re.findall(r"(\w+)\.toml", "".join(re.findall(r"```(?:sh|python)\n(.*?)```", text, re.DOTALL))))
    assert used == set(SCENES)


CORNERS = FOLDER.parent / "corners"


def test_the_block_slides_as_far_as_newmark_says() -> None:
    """V^2 / (2 g N) (1 - N / A), of a rectangular pulse of A = 0.5 g for 0.4 s and friction of N = 0.2 g."""
    (block,) = wavesym.summary(Scene.from_toml(CORNERS / "sliding_block.toml")).links or ()
    g, a, n = 9.80665, 0.5, 0.2
    v = a * g * 0.4
    assert block.set.value == pytest.approx(1000 * v**2 / (2 * g * n) * (1 - n / a), rel=1e-15)
    assert block.set.unit == "mm"


@pytest.mark.slow
def test_teeth_part_and_strike_at_one_flank_or_the_other() -> None:
    """There the pinion is where it was against the gear, or has crossed the play of 10 mrad."""
    scene = Scene.from_toml(CORNERS / "gears_with_backlash.toml")
    events = wavesym.run(scene).events
    motor, gear = wavesym.evaluator(scene)([event.double for event in events])[:2]
    assert [event.kind for event in events] == ["releases", "engages"] * 6
    assert {round(abs(play), 9) for play in (motor - gear).tolist()} == {0, 10}


@pytest.mark.slow
def test_a_driven_pile_gives_its_energy_to_the_soil() -> None:
    """Of 16 kJ that the ram brings, what it and the pile keep and dashpots take is left: the soil's share is less."""
    soil = wavesym.summary(Scene.from_toml(CORNERS / "smith_pile.toml")).links or ()
    assert [link.law for link in soil] == ["spring", "spring"]
    assert {link.between for link in soil} == {("toe", "fixed"), ("ground", "shaft")}
    assert 0 < sum(link.dissipated.value for link in soil) < 16_000


def test_a_bit_breaks_away_when_it_is_wound_up_and_turns_as_far_as_the_table() -> None:
    """It slips at 8 kN m, by a front (tau odd, as the table begins at 0) or between them, and never turns back."""
    scene = Scene.from_toml(CORNERS / "drill_string.toml")
    events = [event for event in wavesym.run(scene).events if event.kind == "slips"]
    assert sum(event.double % 2 == 1 for event in events) == 5
    assert len(events) == 6
    assert wavesym.summary(scene)["velocity@bit"].min.value == 0
