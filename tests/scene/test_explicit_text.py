"""Scenes of named systems written out as chains: the same network, and the same values to the last bit."""

from dataclasses import replace
from fractions import Fraction

import pytest
from flint import fmpq
from hypothesis import given

import wavesym
from tests.support.drawn import systems
from tests.support.scenes import NAMED
from wavesym.cli import main
from wavesym.errors import UnservedError
from wavesym.mechanics.network import Network, Point
from wavesym.scene import Scene, lower
from wavesym.scene.explicit_text import explicit_text
from wavesym.systems import SYSTEMS
from wavesym.systems.drawing import draw_parts


def written(scene: Scene, tmp_path) -> Scene:
    """The scene read back from its text as a chain."""
    file = tmp_path / "explicit.toml"
    file.write_text(explicit_text(scene))
    return Scene.from_toml(str(file))


def bare(network: Network) -> tuple[list[Point], Network]:
    """Points and bars without names and loads; the start of what has no mass does not matter."""
    points = [
        replace(
            point, loads=(), name="", motion=point.motion and "velocity", velocity=point.velocity * bool(point.mass)
        )
        for point in network.points
    ]
    return points, replace(network, points=())


def others() -> list[Scene]:
    """Scenes with unequal numbers, samples, and a base that is driven."""
    building = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "7/5"], "base": "ground"}
    samples = [{"spacing": "1/5", "samples": [1, "1/3", "-2/7", 0]}]
    drive = {"type": "drive", "m": 2, "kappa": ["1/3", 2], "inertia": [1, "3/2", 5]}
    moments = [{"body": 3, "times": [0, "1/2"], "steps": [1, "1/3"]}]
    output = {"until": 5, "velocity": [0, "1/2", 1], "strain": ["1-", "1+"], "displacement": [2]}
    return [
        Scene(name="ground", system=building, load=samples, output=output),
        Scene(name="force", system={**building, "base": "force"}, load=samples, output=output),
        Scene(name="discs", system=drive, load=moments, output=output),
    ]


@given(systems())
def test_parts_of_a_preset_are_the_network_of_its_nodes(system) -> None:
    """Parts are drawn as those of any chain, nodes are the paper's: two ways to the same masses and impedances."""
    preset = SYSTEMS[system["type"]].model_validate(system)
    assert bare(draw_parts(preset.parts, ()).network({})) == bare(preset.network(()))


BUILT_IN = [pytest.param(scene, marks=pytest.mark.slow) for scene in map(Scene.from_toml, NAMED)]


@pytest.mark.quick(1)
@pytest.mark.parametrize("scene", [*BUILT_IN, *others()], ids=lambda scene: scene.name)
def test_the_same_network_and_the_same_values_to_the_last_bit(scene: Scene, tmp_path) -> None:
    explicit = written(scene, tmp_path)
    assert explicit.system.type == "chain"
    assert explicit.output == scene.output
    assert bare(lower(explicit).network) == bare(lower(scene).network)
    one, other = wavesym.evaluator(scene), wavesym.evaluator(explicit)
    assert one.outputs == other.outputs
    taus = [k / 64 for k in range(int(64 * one.tau_max) + 1)]
    assert one(taus).tobytes() == other(taus).tobytes()


def test_closed_contacts_are_rods_joined_and_the_text_says_so(capsys) -> None:
    assert main(["scenes", "collision_m4", "--explicit"]) == 0
    text = capsys.readouterr().out
    assert "contacts are closed" in text
    assert "joined at 2" in text
    assert text.count("rod = 1") == 4


def test_what_is_written_out_already_stays() -> None:
    scene = Scene(
        name="bar",
        system={"type": "chain", "parts": [{"mass": 1, "velocity": Fraction(1)}, {"rod": 1}]},
        output={"until": 1, "velocity": [0]},
    )
    with pytest.raises(
        UnservedError, match="chain has all of its parts written already; write collision, drive or building"
    ):
        explicit_text(scene)
    assert lower(scene).network.bars[0].delay == fmpq(1)


def test_a_name_is_needed(capsys) -> None:
    assert main(["scenes", "--explicit"]) == 2
    assert "NAME" in capsys.readouterr().err
