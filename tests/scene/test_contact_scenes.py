"""Contacts in scenes: where they are in the network, what they are called, and which places need a side."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import fmpq

import wavesym
from wavesym.cli import main
from wavesym.errors import SceneError, UnservedError
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link, Network
from wavesym.scene import Scene, lower
from wavesym.scene.explicit_text import explicit_text

ROD: dict[str, Any] = {"rod": 1}
MASS: dict[str, Any] = {"mass": 3, "name": "hammer"}
COLLISION = {"type": "collision", "m": 6, "kappa": ["1/10", 1, "1/3"], "velocity": [1, "-1/2", -2], "contacts": "open"}
CLOSED = {**COLLISION, "contacts": "closed"}


def chain(parts: list[Any], *branches: dict[str, Any], **more: Any) -> Model:
    system = {"type": "chain", "parts": parts, "branch": branches}
    load = more.pop("load", [])
    return lower(Scene(name="s", system=system, load=load, output={"until": 1, **(more or {"strain": ["1/2"]})}))


def collision(system: dict[str, Any] = COLLISION, **output: Any) -> Scene:
    return Scene(name="bars", system=system, output={"until": 6, **(output or {"velocity": [1]})})


def touching(network: Network) -> list[tuple[int, int, str, fmpq]]:
    return [(link.left, link.right, link.place, link.gap) for link in contacts(network)]


def contacts(network: Network) -> list[Link]:
    return [network.links[number] for number in network.corners]


def test_a_contact_parts_two_points() -> None:
    model = chain([MASS, "contact", ROD, {"contact": "1/3"}, {"rod": "3/2"}, "contact", "fixed"])
    assert touching(model.network) == [(0, 1, "0", 0), (2, 3, "1", fmpq(1, 3)), (4, 5, "5/2", 0)]
    assert [len(joint.points) for joint in model.network.joints] == [2, 2, 2]


CUSHION: dict[str, Any] = {"spring": 4, "dashpot": "1/4"}


def test_between_a_cushion_and_a_contact_is_a_joint() -> None:
    output: dict[str, Any] = {"until": 3, "velocity": ["hammer", "1/2"]}
    for parts in ([MASS, CUSHION, "joint", "contact", ROD], [ROD, "contact", "joint", CUSHION, MASS]):
        said = {"type": "chain", "parts": parts}
        unsaid = {"type": "chain", "parts": [part for part in parts if part != "joint"]}
        one, other = (lower(Scene(name="s", system=each, output=output)) for each in (said, unsaid))
        assert one.network == other.network
        assert [link.contact for link in one.network.links].count(True) == 1


@pytest.mark.parametrize(
    ("parts", "at"),
    [
        ([MASS, {"spring": 4}, "contact", ROD], r"parts\[2\]"),
        ([ROD, "contact", {"spring": 4}, MASS], r"parts\[2\]"),
        (["fixed", {"spring": 4}, {"joint": True, "name": "cap"}, "contact", ROD], r"parts\[2\]"),
        ([{"joint": True, "spring": 4}, "contact", ROD], r"parts\[0\]"),
        ([ROD, "contact", CUSHION, "contact", ROD], r"parts\[2\]"),
    ],
)
def test_what_lifts_off_has_a_motion_of_its_own(parts: list[Any], at: str) -> None:
    with pytest.raises(
        SceneError,
        match=at + ": no mass, rod or dashpot holds a side of a contact.* dashpot beside its spring, or a mass",
    ):
        chain(parts)


def test_two_contacts_at_one_place_are_called_by_its_sides() -> None:
    assert [row[2] for row in touching(chain([ROD, "contact", MASS, "contact", ROD]).network)] == ["1-", "1+"]


def test_a_contact_of_a_branch_is_called_by_it() -> None:
    arm = {"from": "hammer", "name": "arm", "ratio": 2, "parts": [ROD, {"contact": 1}, ROD]}
    foot = {"from": "hammer", "name": "foot", "parts": ["contact", ROD]}
    network = chain([ROD, MASS], arm, foot).network
    assert [row[2] for row in touching(network)] == ["arm:1", "foot:0"]
    assert [link.ratio for link in contacts(network)] == [1, 1]
    assert contacts(network)[1].left == next(k for k, point in enumerate(network.points) if point.mass)


def test_sides_of_a_contact() -> None:
    """The force is one; velocities are two."""
    parts = [ROD, "contact", ROD]
    model = chain(parts, strain=["1"], velocity=["1-", "1+"], displacement=["1+"])
    assert [(probe.rod, probe.place) for probe in model.probes] == [(1, 1), (1, 1), (2, 0), (2, 0)]
    for quantity in ("velocity", "displacement"):
        with pytest.raises(SceneError, match=r'1 has two sides; write "1-" or "1\+"'):
            chain(parts, **{quantity: ["1"]})
    with pytest.raises(SceneError, match=r'load\[0\].at: "1" has two sides'):
        chain(parts, load=[{"at": "1", "times": [0], "steps": [1]}])
    model = chain(parts, load=[{"at": "1+", "times": [0], "steps": [1]}])
    assert [bool(point.loads) for point in model.network.points] == [False, False, True, False]


def test_a_node_and_its_side_of_a_contact_are_one_place() -> None:
    with pytest.raises(SceneError, match=r"velocity\[1\]: 0- is the same place as hammer"):
        chain([MASS, "contact", ROD], velocity=["hammer", "0-"])
    assert len(chain([MASS, "contact", ROD], velocity=["hammer", "0+"]).probes) == 2


@pytest.mark.parametrize(
    ("parts", "load"),
    [
        ([ROD, "contact", {**ROD, "impedance": 2}], []),
        ([ROD, "contact", {**ROD, "speed": 2}], []),
        ([ROD, {"joint": True, "dashpot": 1}, "contact", ROD], []),
        ([ROD, "contact", MASS, "contact", ROD], []),
        ([ROD, "contact", MASS, {"spring": 1}, {"rod": 1}], []),
        ([ROD, "contact", ROD], [{"at": "1-", "times": [0], "steps": [1]}]),
    ],
)
def test_a_strain_at_a_contact_has_two_sides_where_something_else_is_there(parts: list[Any], load: list[Any]) -> None:
    with pytest.raises(SceneError, match="has two sides"):
        chain(parts, load=load, strain=["1"])
    assert [probe.rod for probe in chain(parts, load=load, strain=["1-", "1+"]).probes] == [1, 2]


def test_a_tuned_damper_is_a_branch_without_a_rod() -> None:
    damper = {"from": "hammer", "name": "damper", "parts": [{"spring": 1, "dashpot": "1/10"}, {"mass": "1/20"}]}
    model = chain([ROD, MASS, ROD], damper, velocity=["hammer", "damper:0+"])
    assert len(model.network.bars) == 2
    assert [len(joint.points) for joint in model.network.joints] == [1, 2, 1]
    assert model.network.points[model.probes[1].point or 0].mass == fmpq(1, 20)


def test_a_damper_on_a_branch_does_what_it_does_in_a_line() -> None:
    """At the end of a chain it is the same to draw it onwards."""
    tie, mass, begun = {"spring": 2, "dashpot": "1/10"}, {"mass": "1/3"}, {"rod": 1, "velocity": 1}
    output = {"until": 7, "velocity": ["hammer", "1/2"], "displacement": ["0"]}
    hung = {"type": "chain", "parts": [begun, MASS], "branch": [{"from": "hammer", "name": "d", "parts": [tie, mass]}]}
    drawn = {"type": "chain", "parts": [begun, MASS, tie, mass]}
    taus = [k / 3 for k in range(22)]
    one, other = (wavesym.evaluator(Scene(name="s", system=each, output=output))(taus) for each in (hung, drawn))
    assert one.any()
    assert one.tobytes() == other.tobytes()


def test_an_open_collision_is_its_chain_with_contacts(tmp_path: Path) -> None:
    scene = collision(strain=[2, "3-"], velocity=["2-", "4+", 5], displacement=[6])
    file = tmp_path / "explicit.toml"
    file.write_text(explicit_text(scene))
    explicit = Scene.from_toml(file)
    assert explicit.output == scene.output
    one, other = lower(scene), lower(explicit)
    assert (other.network.bars, other.network.links) == (one.network.bars, one.network.links)
    assert [point.mass for point in other.network.points] == [point.mass for point in one.network.points]
    assert other.probes == one.probes
    assert touching(one.network) == [(2, 3, "2", 0), (5, 6, "4", 0)]
    assert [bar.velocity for bar in one.network.bars] == [1, 1, fmpq(-1, 2), fmpq(-1, 2), -2, -2]


def test_a_scene_of_ones_own_is_written_out_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bars.toml"
    collision = 'type = "collision"\nm = 4\nkappa = [1, 1]\nvelocity = [1, 0]\ncontacts = "open"'
    file.write_text(f'name = "bars"\n[system]\n{collision}\n[output]\nuntil = 1\nvelocity = [0]\n')
    assert main(["scenes", str(file), "--explicit"]) == 0
    text = capsys.readouterr().out
    assert text.count('"contact"') == 1
    assert "closed" not in text
    file.write_text(text)
    assert main(["scenes", str(file), "--explicit"]) == 2
    assert "system.type: a chain has all of its parts written already" in capsys.readouterr().err
    assert main(["scenes", "stepped_shaft", "--explicit"]) == 0
    assert "brake" in capsys.readouterr().out


def test_what_a_closed_collision_is_does_not_change() -> None:
    """Neither its hash nor its network: `contacts` was not there before."""
    said, unsaid = collision(CLOSED), collision({key: value for key, value in CLOSED.items() if key != "contacts"})
    assert said == unsaid
    assert lower(said) == lower(unsaid)
    assert "contacts" not in said.model_dump()["system"]
    assert collision().model_dump()["system"]["contacts"] == "open"
    assert lower(collision()).labels.sha256 != lower(said).labels.sha256
    assert said.with_({"system.contacts": "open"}) == collision()
    assert not lower(said).network.corners


def test_sides_of_an_open_collision() -> None:
    with pytest.raises(SceneError, match=r'velocity\[0\]: 2 has two sides, where bodies touch; write "2-" or "2\+"'):
        collision(velocity=[2])
    with pytest.raises(SceneError, match=r'contacts: "no" is unknown; write "closed" or "open"'):
        collision({**COLLISION, "contacts": "no"})
    probes = lower(collision(velocity=["2-", "2+", 3], strain=[4, Fraction(1, 2)])).probes
    assert [(probe.rod, probe.place) for probe in probes] == [(4, 1), (1, fmpq(1, 2)), (2, 1), (3, 0), (3, 1)]


@pytest.mark.parametrize("parts", [[MASS, "contact", ROD], [ROD, {"contact": 1}, ROD]])
def test_what_has_one_law_refuses_contacts(parts: list[Any]) -> None:
    with pytest.raises(UnservedError, match=r"system: the contact at \S+ opens and closes, .* march"):
        chain(parts).network.refuse_corners()
    with pytest.raises(UnservedError, match=r"system: the contact at \S+ opens and closes"):
        lower(collision()).network.refuse_corners()
