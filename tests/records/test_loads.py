"""Records as loads: 0, straight lines through the samples, 0 again; part of a scene by what they hold."""

import json
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import wavesym
from tests.records.test_files import AT2, CSV, EL_CENTRO, made
from wavesym.cli import main
from wavesym.errors import SceneError
from wavesym.scene import Scene, lower

EXAMPLES = Path(__file__).parents[2] / "examples"
TAU = "tau,a\n0,1/2\n".replace("1/2", "0.5") + "0.4,-1\n0.8,0.25\n"
BUILDING = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "ground"}
DRIVE = {"type": "drive", "m": 2, "kappa": ["1/2", 1], "inertia": [1, 2, 1]}
CHAIN = {"type": "chain", "parts": [{"mass": 1, "name": "hit"}, {"rod": 1}, {"mass": 2}]}
SYSTEMS = [(BUILDING, {}), (DRIVE, {"body": 2}), (CHAIN, {"at": "hit"})]
OUTPUT = {"until": 4, "displacement": [0, 1]}
FRAME = """name = "frame"
[units]
[system]
type = "building"
base = "ground"
[[system.storey]]
count = 3
height = "3.5 m"
stiffness = "678 MN/m"
column_mass = "10.871 t"
floor_mass = "350 t"
[[load]]
record = "quake.txt"
[output]
until = "80 ms"
displacement = [3]
"""


def scene(load: dict[str, object], system: dict[str, object] = BUILDING, **output: object) -> Scene:
    return Scene(name="recorded", system=system, load=[load], output=OUTPUT | output)


def value(made: Scene, tau: Fraction) -> Fraction:
    """What all loads add up to, just after tau."""
    total = Fraction(0)
    for load in made.load:
        step, ramp = load.sources
        for unit in load.units():
            since = tau - Fraction(str(unit.time))
            assert unit.source in (step, ramp)
            if since >= 0:
                total += Fraction(str(unit.weight)) * (1 if unit.source == step else since)
    return total


def drawn_through(points: list[tuple[Fraction, Fraction]], tau: Fraction) -> Fraction:
    """Straight lines through points, 0 outside them."""
    for (t0, y0), (t1, y1) in pairwise(points):
        if t0 <= tau < t1:
            return y0 + (y1 - y0) * (tau - t0) / (t1 - t0)
    return Fraction(0)


NUMBERS = st.fractions(-2, 2, max_denominator=20)


@given(
    samples=st.lists(NUMBERS, min_size=1, max_size=6),
    spacing=st.fractions(Fraction(1, 9), 2, max_denominator=9),
    late=st.one_of(st.just(Fraction(0)), st.fractions(1, 3, max_denominator=7)),
    scale=NUMBERS,
    tau=st.fractions(0, 20, max_denominator=63),
)
def test_a_record_is_its_samples_joined_and_0_before_and_after(samples, spacing, late, scale, tau):
    start = late * spacing
    load = {"record": {"samples": samples}, "spacing": spacing, "start": start, "scale": scale}
    before = [(start - spacing, Fraction(0))] if start else []
    points = [(start + k * spacing, scale * sample) for k, sample in enumerate(samples)]
    after = (start + len(samples) * spacing, Fraction(0))
    made = scene(load)
    for at in (tau, *(time for time, _ in points), after[0]):
        assert value(made, at) == drawn_through([*before, *points, after], at)


@pytest.mark.quick(1)
@pytest.mark.parametrize("damping", [0.05, "5 %", {"modes": [1, 2], "ratio": 0.05}])
@pytest.mark.parametrize("given", [{}, {"start": 0}])
def test_a_damped_record_rises_to_its_first_sample(damping, given):
    """Modes take no jump: the record begins one spacing later, which a line says."""
    load = {"record": {"samples": [1, -1, "1/2"]}, "spacing": "2/5", "scale": 3, **given}
    made = scene(load, BUILDING | {"damping": damping})
    points = [(Fraction(2 * k, 5), Fraction(y)) for k, y in enumerate([0, 3, -3, "3/2", 0])]
    for at in [*(time for time, _ in points), Fraction(1, 7), Fraction(11, 7), Fraction(3)]:
        assert value(made, at) == drawn_through(points, at)
    assert lower(made).labels.notes == (
        "load[0].record: the first sample is not 0, and modes take no jump: the load rises to it from 0 in a straight "
        'line over one spacing, so that the record begins 2/5 later; write start = "2/5", which says the same, or a '
        "later one (without damping it jumps)",
    )
    told = scene(load | {"start": "2/5"}, BUILDING | {"damping": damping})
    assert (lower(told).loads, lower(told).labels.notes) == (lower(made).loads, ())
    again = Scene(**json.loads(json.dumps(made.model_dump(mode="json"))))
    assert lower(again) == lower(made)
    assert np.isfinite(wavesym.evaluator(made)([1.0, 4.0])).all()


def test_a_record_that_says_when_it_starts_is_moved_by_samples(tmp_path):
    """A `start` in the scene would be refused there; and frequencies, which no load changes, are told without it."""
    (tmp_path / "quake.csv").write_text("time,a\n0,1\n0.4,-1\n")
    text = 'name = "a"\n[system]\ntype = "building"\nm = 2\nkappa = [1, 1, 1]\nbase = "ground"\ndamping = 0.3\n'
    (tmp_path / "a.toml").write_text(f'{text}[[load]]\nrecord = "quake.csv"\n[output]\nuntil = 3\nvelocity = [1]\n')
    made = Scene.from_toml(tmp_path / "a.toml")
    damped, jump = sorted(lower(made).labels.notes, key=lambda note: "jump" in note)
    assert "put samples of 0 before it in the file for another start" in jump
    assert wavesym.modes(made).notes == (damped,)
    assert wavesym.frf(made, [0.5]).notes[:-1] == (damped,)


@pytest.mark.parametrize(
    ("load", "damping"),
    [
        ({"record": {"samples": [0, -1]}}, 0.05),  # no jump
        ({"record": {"samples": [1, -1]}, "start": "2/5"}, 0.05),  # begins later
        ({"record": {"samples": [1, -1]}, "scale": 0}, 0.05),
        ({"record": {"samples": [1, -1]}}, 0),  # not damped
    ],
)
def test_other_records_begin_when_they_say(load, damping):
    made = scene({"spacing": "2/5", **load}, BUILDING | {"damping": damping})
    undamped = scene({"spacing": "2/5", **load})
    assert lower(made).loads == lower(undamped).loads
    assert lower(made).labels.notes == ()


@pytest.mark.slow
def test_el_centro_shakes_a_damped_frame_without_a_start(tmp_path, capsys):
    """Our own example, whose first sample is not 0: what `start` says is done, and said."""
    frame = (EXAMPLES / "frames" / "steel.toml").read_text().replace("../records", str(EXAMPLES / "records"))
    assert 'start = "0.02 s"' in frame
    found = []
    for name, text in (("told", frame), ("untold", frame.replace('start = "0.02 s"', ""))):
        path = tmp_path / f"{name}.toml"
        path.write_text(text.replace("31.18 s", "0.2 s"))
        assert main(["run", str(path), "--samples", "5"]) == 0
        found.append(capsys.readouterr())
    assert found[0].out == found[1].out
    assert "so that the record begins 0.02 s later" in found[1].err
    assert "later" not in found[0].err


def test_a_drawn_line_is_seen_to_be_broken():
    """The check above fails for `samples`, which stay constant."""
    assert value(scene({"spacing": 1, "samples": [0, 1]}), Fraction(3)) == 1 != drawn_through([(0, 0), (1, 1)], 3)


@pytest.mark.parametrize(("system", "on"), SYSTEMS)
def test_a_record_does_what_the_same_steps_and_ramps_do(tmp_path, system, on):
    path = made(tmp_path, TAU)
    named = ("a", "b") if system is BUILDING else ("steps", "ramps")
    times = [0, "2/5", "4/5", "6/5"]
    slopes = [Fraction(-15, 4), Fraction(25, 8) + Fraction(15, 4), Fraction(-5, 8) - Fraction(25, 8), Fraction(5, 8)]
    written = {"times": times, named[0]: ["1/2", 0, 0, 0], named[1]: slopes}
    recorded = scene({"record": str(path)} | on, system)
    assert lower(recorded).loads == lower(scene(written | on, system)).loads
    sampled = {"spacing": "2/5", "samples": ["1/2", -1, "1/4", 0]}
    assert lower(recorded).loads == lower(scene(sampled | on, system)).loads


def test_a_chain_written_out_moves_as_its_drive_does(tmp_path):
    """A record on a disc, on the paper's clocks and on those of a network, which derive on their own."""
    from wavesym.scene.explicit_text import explicit_text

    drive = scene({"record": str(made(tmp_path, TAU)), "body": 2}, DRIVE, strain=["1/2", "1+"], velocity=[2])
    (tmp_path / "chain.toml").write_text(explicit_text(drive))
    chain = Scene.from_toml(tmp_path / "chain.toml")
    taus = np.linspace(0, 4, 33)
    np.testing.assert_array_equal(wavesym.evaluator(drive)(taus), wavesym.evaluator(chain)(taus))


def test_the_ground_stops_accelerating_after_a_record(tmp_path):
    """Its velocity then is the area under the lines."""
    velocity = wavesym.evaluator(scene({"record": str(made(tmp_path, TAU))}, velocity=[0]))
    area = (0.5 - 1) * 0.2 + (-1 + 0.25) * 0.2 + 0.25 * 0.2
    assert velocity([1.2, 2.0, 4.0])[0] == pytest.approx([area] * 3, rel=0, abs=1e-15)


def test_scenes_are_equal_that_hold_the_same_record(tmp_path):
    one, other = (scene({"record": str(made(tmp_path, TAU, name))}) for name in ("a.csv", "b.txt"))
    changed = scene({"record": str(made(tmp_path, TAU.replace("-1", "-2"), "c"))})
    assert lower(one).labels.sha256 == lower(other).labels.sha256 != lower(changed).labels.sha256
    assert str(tmp_path) not in json.dumps(one.model_dump(mode="json"))


@pytest.mark.parametrize("mode", ["python", "json"])
def test_a_scene_is_what_it_is_dumped_as(tmp_path, mode):
    path = made(tmp_path, "note,x\nfirst,0.5\n,2\n")
    load = {"record": path, "column": "x", "spacing": "1/3", "start": "2/3", "scale": -2}
    given = scene(load)
    path.unlink()  # it is not read again
    dumped = given.model_dump(mode=mode)
    again = Scene(**(json.loads(json.dumps(dumped)) if mode == "json" else dumped))
    assert again.load == given.load
    assert lower(again) == lower(given)


def test_a_record_is_changed_by_its_path(tmp_path):
    given = scene({"record": str(made(tmp_path, TAU)), "scale": 2})
    other = given.with_({"load[0].record": str(made(tmp_path, TAU.replace("-1", "-2"), "b"))})
    assert value(other, Fraction(2, 5)) == -4
    assert value(other.with_({"load[0].scale": 1}), Fraction(2, 5)) == -2
    assert value(other.with_({"load[0].record.samples[1]": 3}), Fraction(2, 5)) == 6


def test_a_path_counts_from_the_file_of_the_scene(tmp_path, monkeypatch, capsys):
    from wavesym.cli import main

    folder = tmp_path / "there"
    folder.mkdir()
    made(folder, TAU, "a.csv")
    text = (
        'name = "s"\n[system]\ntype = "building"\nm = 2\nkappa = [1, 1, 1]\nbase = "ground"\n'
        '[[load]]\nrecord = "a.csv"\n[output]\nuntil = 2\nvelocity = [0]\n'
    )
    (folder / "s.toml").write_text(text)
    monkeypatch.chdir(tmp_path)
    assert value(Scene.from_toml("there/s.toml"), Fraction(0)) == Fraction(1, 2)
    (folder / "s.toml").write_text(text.replace("a.csv", str(folder / "a.csv")))
    assert value(Scene.from_toml("there/s.toml"), Fraction(0)) == Fraction(1, 2)
    made(folder, TAU.replace("0.8", "0.7"), "a.csv")
    assert main(["run", "there/s.toml"]) == 2
    err = capsys.readouterr().err
    assert err.startswith(f"there/s.toml: load[0].record: {folder / 'a.csv'}: line 4: the time 0.7 should be 0.8")
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("text", "load", "said"),
    [
        (AT2, {}, r"load\[0\].record: the file says s and g, but the scene has no units"),
        (CSV, {}, r"load\[0\].record: the file says s and g, but the scene has no units"),
        ("t,x [kN]\n0,1\n1,1\n", {}, r"load\[0\].record: the file says kN, but the scene has no units"),
        (
            "x\n1\n",
            {},
            r"load\[0\].spacing: missing, and the file does not say it; write the time between samples",
        ),
        ("x\n1\n", {"spacing": 0}, r"load\[0\].spacing: 0 is not positive; write a number above 0"),
        (TAU, {"spacing": "1/2"}, r"load\[0\].record: .*: line 3: the time 0.4 should be 0.5"),
        (TAU, {"start": 1}, r"load\[0\].start: 1, but the file says 0; write that, or nothing"),
        (
            "x\n1\n",
            {"spacing": 1, "start": "1/2"},
            r"load\[0\].start: a first sample after 0.5 steps, but the load comes from 0",
        ),
        (
            "x\n1\n",
            {"spacing": 1, "start": -1},
            r"load\[0\].start: a first sample after -1 steps, but the load comes from 0",
        ),
        ("t,x\n1,1\n3,1\n", {}, r"load\[0\].record: a first sample after 0.5 steps, but the load comes from 0"),
        (TAU, {"column": "b"}, r"load\[0\].record: .*: line 1: no column called b; write the name of one \(a\)"),
        (TAU, {"column": 2}, r"load\[0\].column: 2 is not a name; write that of a column"),
        (TAU, {"times": [0]}, r"load\[0\].times: unknown key; write name, column, spacing, start, scale or record"),
    ],
)
def test_what_does_not_fit_is_refused_in_a_line(tmp_path, text, load, said):
    with pytest.raises(SceneError, match=f"^scene: {said}") as error:
        scene({"record": str(made(tmp_path, text))} | load)
    assert "\n" not in str(error.value)


def physical(folder: Path, record: str | Path, more: str = "") -> Scene:
    text = FRAME.replace("quake.txt", str(record)).replace("[output]", f"{more}\n[output]")
    (folder / "frame.toml").write_text(text)
    return Scene.from_toml(folder / "frame.toml")


def test_at2_that_begins_at_its_first_step_is_the_table(tmp_path):
    """El Centro has a(0) = 0, which its AT2 leaves out."""
    at2, table = EL_CENTRO.with_suffix(".at2"), EL_CENTRO.with_suffix(".csv")
    tabled = lower(physical(tmp_path, table))
    assert lower(physical(tmp_path, at2, 'start = "0.02 s"')).loads == tabled.loads
    assert lower(physical(tmp_path, at2)).loads != tabled.loads


def test_a_physical_record_has_the_units_of_its_file_or_of_the_scene(tmp_path):
    """The peak of El Centro as an acceleration, exact: 0.31882 g over what one is in the scene."""
    said = physical(tmp_path, EL_CENTRO.with_suffix(".csv"), 'unit = "g"\nspacing = "20 ms"')
    (load,) = said.load
    seconds = Fraction(str(said.scale.seconds))
    assert load.step * seconds == Fraction(1, 50)
    size = min(load.record.samples) / Fraction("-0.31882")
    bare = made(tmp_path, f"x\n0\n-{Decimal('0.31882') * Decimal('9.80665')}\n", "bare.csv")
    other = physical(tmp_path, bare, 'unit = "m/s^2"\nspacing = "1/50 s"\nscale = -1')
    assert max(other.load[0].record.samples) == 0
    assert value(other, Fraction(1, 50) / seconds) == Fraction("0.31882") * size


@pytest.mark.parametrize(
    ("text", "more", "said"),
    [
        (CSV, 'unit = "m/s^2"', r'unit: "m/s\^2", but the file says g; write that, or nothing'),
        (AT2, 'spacing = "25 ms"', 'spacing: "25 ms", but the file says 0.02 s; write that, or nothing'),
        (CSV, 'start = "1 s"', 'start: "1 s", but the file says 0 s; write that, or nothing'),
        (CSV.replace("accel_g", "a"), "", r'unit: missing; write the unit of the samples, such as "g"'),
        (
            CSV.replace("accel_g", "force [kN]"),
            "",
            r'record: .*quake.txt: line 2: "kN" is a force, not an acceleration',
        ),
        (
            CSV.replace("time_s", "time [parsec]"),
            "",
            r'record: .*quake.txt: line 2: "parsec" is a length, not a time',
        ),
        (AT2, "start = 1", 'start: 1 is not a time; write one such as "20 ms"'),
        (AT2.replace("-.25", "nan"), "", r"record: .*quake.txt: line 5: word 2"),
    ],
)
def test_units_that_do_not_fit_are_refused_in_a_line(tmp_path, text, more, said):
    path = made(tmp_path, text, "quake.txt")
    with pytest.raises(SceneError, match=rf"frame.toml: load\[0\]\.{said}") as error:
        physical(tmp_path, path.name, more)
    assert "\n" not in str(error.value)


def test_milliseconds_of_a_file_are_those_of_a_scene(tmp_path):
    text = "time [ms],a [g]\n0,1\n3.3,2\n6.7,3\n10.0,4\n"
    rounded = physical(tmp_path, made(tmp_path, text).name, 'spacing = "1/300 s"')
    assert rounded.load[0].step * Fraction(str(rounded.scale.seconds)) == Fraction(1, 300)


def test_a_physical_scene_is_what_it_is_dumped_as(tmp_path):
    given = physical(tmp_path, EL_CENTRO.with_suffix(".at2"), 'start = "0.02 s"')
    dumped = json.loads(json.dumps(given.model_dump(mode="json")))
    assert lower(Scene(**dumped)) == lower(given)
    assert str(EL_CENTRO.parent) not in json.dumps(dumped)
    table = given.with_({"load[0].record": str(EL_CENTRO.with_suffix(".csv")), "load[0].start": "0 s"})
    assert lower(table).loads == lower(given).loads
