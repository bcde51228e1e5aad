"""What users stumbled over: each is one clear line, before anything is overwritten or worked at for long."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import click
import numpy as np
import pytest

import wavesym
from tests.cli.test_cli import SCENE, folder, refused
from wavesym import api
from wavesym.cli import COMMANDS, cli, main
from wavesym.results import rows
from wavesym.scene import Scene, builtin_names, lower
from wavesym.scene.first_scene import IN_UNITS, KINDS, first_scene

__all__ = ["folder"]

LOAD = """[[load]]
body = 1
times = [0]
steps = [1]
"""
LOADED = SCENE.replace("[output]", LOAD + "[output]")


def wavesym_in_a_shell(line: str) -> subprocess.CompletedProcess[str]:
    command = line.replace("wavesym", f"{sys.executable} -m wavesym", 1)
    return subprocess.run(command, shell=True, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("line", ["wavesym run mine.toml >&-", "wavesym --help >&-", "wavesym scenes >&-"])
def test_a_closed_standard_output_is_one_line(line: str) -> None:
    done = wavesym_in_a_shell(line)
    assert done.returncode == 2
    assert done.stderr == "wavesym: standard output is closed; open it, or write a file with -o\n"


def test_many_samples_come_while_they_are_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The reader of the first lines does not wait for the last ones."""
    scene = wavesym.Scene.from_toml("drive_m1")
    asked = []
    made = rows._rows
    monkeypatch.setattr(rows, "_rows", lambda *of: asked.append(1) or made(*of))
    lines = api.run_csv(scene, 10**7)
    assert next(lines).startswith("tau,")
    assert next(lines).startswith("0.0,")
    assert asked == [1]
    whole = list(api.run_csv(scene, 2 * rows._AT_ONCE + 3))
    assert len(whole) == 2 * rows._AT_ONCE + 4
    assert whole[-1].startswith("10.0,")
    assert list(api.run_csv(scene, 101)) == list(api.run_csv(scene, 101, list(rows.grid(lower(scene), 101))))


def test_a_byte_order_mark_is_no_part_of_a_scene() -> None:
    Path("marked.toml").write_text(SCENE, encoding="utf-8-sig")
    assert wavesym.Scene.from_toml("marked.toml") == wavesym.Scene.from_toml("mine.toml")


def test_a_scene_and_a_sweep_are_told_apart(capsys: pytest.CaptureFixture[str]) -> None:
    Path("sweep.toml").write_text('scene = "mine.toml"\n[vary]\n"output.until" = [1, 2]\n')
    assert refused(capsys, "run", "sweep.toml").startswith("sweep.toml: this is a sweep, not a scene")
    assert refused(capsys, "sweep", "mine.toml", "-o", "made").startswith("mine.toml: this is a scene, not a sweep")
    assert not Path("made").exists()


@pytest.mark.parametrize("command", ["run", "tables", "plot", "chart"])
def test_a_scene_is_not_replaced_by_what_is_made_of_it(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    line = refused(capsys, command, "mine.toml", "-o", "./mine.toml")
    assert "mine.toml is the scene itself; write another file" in line
    Path("linked.toml").symlink_to("mine.toml")
    assert "linked.toml is the scene itself" in refused(capsys, command, "mine.toml", "-o", "linked.toml")
    assert Path("mine.toml").read_text() == SCENE


def test_files_of_others_are_replaced_by_force_only(capsys: pytest.CaptureFixture[str]) -> None:
    Path("there").mkdir()
    Path("there", "mine.c").write_text("int main(void) { return 0; }\n")
    Path("loaded.toml").write_text(LOADED)
    line = refused(capsys, "generate", "loaded.toml", "-o", "there", "--language", "all")
    assert line == f"loaded.toml: {Path('there/mine.c')}: exists and was not written by wavesym; --force replaces it"
    assert main(["generate", "loaded.toml", "-o", "there", "--language", "all", "--force"]) == 0
    assert len(list(Path("there").iterdir())) == 5
    # all of them are now its own
    assert main(["generate", "loaded.toml", "-o", "there", "--language", "all"]) == 0


@pytest.mark.parametrize("command", [["chart", "mine.toml", "-o"], ["stability", "-o"], ["plot", "--published", "-o"]])
def test_what_takes_long_first_asks_where_it_may_write(
    command: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for work in ("lab.chart.measure.measure", "lab.stability.atlas", "pictures.figures.write_figure"):
        monkeypatch.setattr(f"wavesym.{work}", lambda *_: pytest.fail("worked before it asked"))
    assert refused(capsys, *command, "mine.toml/deeper/out.svg").endswith(": Not a directory")


def test_times_beyond_the_horizon_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    Path("loaded.toml").write_text(LOADED)
    Path("at.txt").write_text("1\n2.5\n-1\n")
    assert main(["run", "loaded.toml", "--at", "at.txt"]) == 0
    out, err = capsys.readouterr()
    assert out.count("nan") == 2
    assert err == "mine: 2 of 3 tau are outside 0 to 2, where values are nan\n"


@pytest.mark.quick(1)
@pytest.mark.parametrize("command", ["run", "generate", "plot"])
def test_a_scene_without_a_load_is_told(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = [command, "mine.toml", *(["-o", "mine.svg"] if command == "plot" else [])]
    main(arguments)
    assert "mine: no load, so that all outputs are 0\n" in capsys.readouterr().err
    Path("mine.toml").write_text(LOADED)
    main(arguments)
    assert "no load" not in capsys.readouterr().err


def test_a_striker_that_flies_away_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    text = """name = "bars"
[system]
type = "chain"
parts = [{ rod = 1, velocity = VELOCITY }, "contact", { rod = 1 }]
[output]
until = 2
strain = [1.5]
"""
    for velocity, told in (("-1", True), ("1", False)):
        Path("mine.toml").write_text(text.replace("VELOCITY", velocity))
        assert main(["summary", "mine.toml"]) == 0
        assert ("its two sides move apart from the start" in capsys.readouterr().err) == told


@pytest.mark.parametrize(
    ("right", "wrong", "meant"),
    [("mass = 1", "mas = 1", "mass"), ('"contact"', '"contct"', "contact"), ('["anvil"]', '["anvill"]', "anvil")],
)
def test_a_part_or_place_that_was_meant_is_asked(
    right: str, wrong: str, meant: str, capsys: pytest.CaptureFixture[str]
) -> None:
    text = """name = "bars"
[system]
type = "chain"
parts = [{ mass = 1, velocity = 1 }, { rod = 1 }, "contact", { rod = 1 }, { mass = 2, name = "anvil" }]
[output]
until = 2
velocity = ["anvil"]
"""
    Path("mine.toml").write_text(text.replace(right, wrong, 1))
    assert refused(capsys, "run", "mine.toml").count(f'Did you mean "{meant}"?') == 1


def test_what_was_meant_is_asked(capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(capsys, "genrate", "mine.toml").startswith(
        "wavesym: No such command 'genrate'. Did you mean \"generate\"?"
    )
    assert "Did you mean" not in refused(capsys, "zzz")
    assert refused(capsys, "run", "building_m3").endswith('. Did you mean "building_m2"?')
    Path("mine.toml").write_text(SCENE.replace("until", "untill"))
    assert refused(capsys, "run", "mine.toml").endswith('. Did you mean "until"? (line 8)')


@pytest.mark.parametrize("name", builtin_names())
def test_a_built_in_scene_is_printed(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes", name]) == 0
    Path("copy.toml").write_text(capsys.readouterr().out, encoding="utf-8")
    assert wavesym.Scene.from_toml("copy.toml") == wavesym.Scene.from_toml(name)


def test_a_scene_that_is_not_built_in(capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(capsys, "scenes", "drive_m2").endswith('Did you mean "drive_m1"?')


@pytest.mark.quick(1)
@pytest.mark.parametrize("kind", KINDS)
def test_a_scene_to_start_from_works_and_is_explained(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["init", kind]) == 0
    text = capsys.readouterr().out
    assert all(len(line) <= 130 for line in text.splitlines())
    assert text.startswith("#:schema scene.schema.json\n# ")
    assert text.count(" # ") >= 7
    Path("first.toml").write_text(text, encoding="utf-8")
    scene = wavesym.Scene.from_toml("first.toml")
    assert (scene.units is not None) == (kind in IN_UNITS)
    assert np.all(np.isfinite(scene.run(samples=3).values))


@pytest.mark.slow
def test_the_soil_of_the_pile_to_start_from_yields(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["init", "pile"]) == 0
    Path("first.toml").write_text(capsys.readouterr().out, encoding="utf-8")
    events = wavesym.run(wavesym.Scene.from_toml("first.toml")).events
    assert {event.kind for event in events} == {"yields", "holds", "releases"}  # the ram, of its cushion


def test_a_scene_to_start_from_takes_a_record(capsys: pytest.CaptureFixture[str]) -> None:
    Path("quake.csv").write_text("time,acc\n0,0\n0.5,0.1\n1,-0.2\n")
    for kind, unit in (("frame", "g"), ("wall", "g"), ("soil", "g"), ("drive", "N*m")):
        assert main(["init", kind, "--record", "quake.csv"]) == 0
        text, err = capsys.readouterr()
        assert f'unit = "{unit}"' in text
        assert err.startswith(
            f'init: quake.csv does not say the unit of its samples: "{unit}" is assumed; write --unit '
        )
        Path("first.toml").write_text(text, encoding="utf-8")
        scene = wavesym.Scene.from_toml("first.toml")
        assert [len(load.record.samples) for load in scene.load] == [3]
        assert float(wavesym.evaluator(scene).tau_max * wavesym.evaluator(scene).seconds_per_tau) == pytest.approx(1)
    assert refused(capsys, "init", "impact", "--record", "quake.csv").startswith("--record: a scene of impact takes no")
    assert refused(capsys, "init", "frame", "--record", "none.csv").startswith("none.csv: No such file or directory")
    Path("acc.csv").write_text("time [s],ground [m/s^2]\n0,0\n0.01,1\n0.02,0\n")
    Path("torque.csv").write_text("time [s],torque [kN*m]\n0,0\n0.01,1\n0.02,0\n")
    for kind, file, said in (
        ("drive", "acc.csv", "acc.csv: samples in m/s^2; the load of a drive is a moment"),
        ("frame", "torque.csv", "torque.csv: samples in kN*m; the load of a frame is an acceleration"),
    ):
        assert refused(capsys, "init", kind, "--record", file) == said


@pytest.mark.slow
def test_a_scene_to_start_from_has_the_unit_of_its_record(capsys: pytest.CaptureFixture[str]) -> None:
    """1 m/s^2 is 1/9.80665 g: the same file acts so much less."""
    Path("quake.csv").write_text("time,acc\n0,0\n0.5,1\n1,-2\n")
    largest = {}
    for unit in ("g", "m/s^2"):
        assert main(["init", "frame", "--record", "quake.csv", "--unit", unit, "-o", "first.toml"]) == 0
        assert capsys.readouterr() == ("", "")
        largest[unit] = wavesym.summary(wavesym.Scene.from_toml("first.toml"))["drift@1"].max.value
        Path("first.toml").unlink()
    assert largest["g"] == pytest.approx(9.80665 * largest["m/s^2"], rel=1e-9)
    Path("acc.csv").write_text("time,acc [m/s^2]\n0,0\n0.5,1\n1,-2\n")
    assert main(["init", "frame", "--record", "acc.csv", "--unit", "m/s^2"]) == 0
    out, err = capsys.readouterr()
    assert not err
    assert "\nunit = " not in out
    Path("bare.csv").write_text("acc\n0\n1\n-2\n")
    assert main(["init", "frame", "--record", "bare.csv"]) == 0
    assert [line.partition(': "')[2] for line in capsys.readouterr().err.splitlines()] == [
        'g" is assumed; write --unit m/s^2 where that is it',
        '0.01 s" is assumed; write another `spacing` in the scene where that is it',
    ]
    for options, said in (
        (["--record", "quake.csv", "--unit", "mm"], '--unit: "mm" is a length, not an acceleration'),
        (["--record", "acc.csv", "--unit", "g"], "acc.csv: --unit g is not that of the file; write m/s^2, or none"),
        (["--unit", "g"], '--unit: "g" is that of a record; write --record FILE too'),
    ):
        assert refused(capsys, "init", "frame", *options).startswith(said)


def test_from_python_what_is_wrong_is_told() -> None:
    scene = wavesym.Scene.from_toml("drive_m1")
    with pytest.raises(wavesym.WavesymError, match=r"^language: fmu is unknown; write c, numpy or all$"):
        wavesym.generate(scene, language="fmu")
    with pytest.raises(
        wavesym.WavesymError, match=r"^evaluator: clsed is unknown; write auto, closed, pieces, march or modes$"
    ):
        wavesym.generate(scene, evaluator="clsed")
    with pytest.raises(wavesym.WavesymError, match=r"^precision: half is unknown; write double or single$"):
        wavesym.generate(scene, precision="half")
    for wanted in (wavesym.evaluator, wavesym.summary, wavesym.tables, wavesym.generate):
        with pytest.raises(wavesym.SceneError, match="str is not a Scene"):
            wanted("drive_m1")  # type: ignore[operator]
    with pytest.raises(wavesym.SceneError, match="str is not a Scene"):
        wavesym.model("drive_m1", ["load"])  # type: ignore[arg-type]
    with pytest.raises(wavesym.WavesymError, match=r'^runtime: "kappa" is not a list of names; write \["kappa"\]$'):
        wavesym.model(scene, "kappa")
    with pytest.raises(wavesym.WavesymError, match=r'^--runtime: kapa is unknown; write .*. Did you mean "kappa"\?$'):
        wavesym.model(scene, ["kapa"])
    with pytest.raises(wavesym.WavesymError, match=r"^--runtime: x is unknown; write kappa, inertia or load$"):
        wavesym.model(scene, ["x"])
    assert issubclass(wavesym.CostError, wavesym.WavesymError)
    assert issubclass(wavesym.ToleranceError, wavesym.WavesymError)


def test_a_scene_with_other_values() -> None:
    scene = wavesym.Scene.from_toml("building_m2")
    other = scene.with_({"system.kappa[1]": "1/3", "output.until": 40, "load[0].a[2]": 7})
    assert [str(kappa) for kappa in other.system.kappa] == ["1/4", "1/3", "1/5"]
    assert (other.output.until, other.load[0].a[2]) == (40, 7)
    assert other.output.strain == scene.output.strain
    assert scene == wavesym.Scene.from_toml("building_m2")


@pytest.mark.parametrize(
    ("path", "wrong"),
    [
        ("system.kapa[1]", 'system.kapa[1]: nothing called "kapa". Did you mean "kappa"?'),
        ("system.kappa[9]", "system.kappa[9]: nothing at [9]"),
        ("output.until[0]", "output.until[0]: nothing at [0]"),
        ("system..m", 'system..m: not a path; write one such as "output.until" or "load[0].times[2]"'),
        ("", 'scene: not a path; write one such as "output.until" or "load[0].times[2]"'),
        (
            "output.untill",
            "output.untill: unknown key",
        ),
        ("system.kappa[1]", "system.kappa[1]: -1 is not positive; write a number above 0"),
    ],
)
def test_a_path_that_leads_nowhere(path: str, wrong: str) -> None:
    with pytest.raises(wavesym.SceneError) as found:
        wavesym.Scene.from_toml("building_m2").with_({path: -1})
    assert wrong in str(found.value)


@pytest.mark.slow
def test_a_package_is_checked_with_all_its_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["generate", "drive_m1", "--package", "-o", str(tmp_path / "out")]
    assert main(asked) == 0
    capsys.readouterr()
    assert (main([*asked, "--check"]), capsys.readouterr().out) == (0, "")
    cmake = tmp_path / "out" / "CMakeLists.txt"
    cmake.write_text(cmake.read_text() + "# mine\n")
    assert main([*asked, "--check"]) == 1
    assert capsys.readouterr().out.startswith(f"changed: {cmake}\n")
    cmake.unlink()
    assert main([*asked, "--check"]) == 1
    assert capsys.readouterr().out.startswith(f"missing: {cmake}\n")


def test_names_of_files_are_no_commands_to_a_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    """In what is refused, and in what is said of a record."""
    name = "a\x1b[2J\x07.csv"
    Path(name).write_text("t,a\n0,0\n1,2\n2,0\n")
    for command in (["run", name], ["record", name], ["record", "none-" + name], ["sweep", name, "--status"]):
        main(command)
        told = capsys.readouterr()
        lines = (told.out + told.err).splitlines()
        assert all(line.isprintable() for line in lines), command
        assert "a\\x1b[2J\\x07.csv" in lines[0]


@pytest.mark.slow
def test_a_column_of_soil_under_a_record_that_begins_with_a_jump_has_accelerations() -> None:
    """No place without mass is accelerated by a jump: the load rises to the first sample."""
    record = Path(__file__).parents[2] / "examples/records/elcentro_1940_ns_peknold.at2"
    text = first_scene("soil", record).text.replace("strain = ", 'acceleration = ["40 m"]\nstrain = ')
    scene = Scene.from_toml(text).with_({"output.until": "1 s"})
    assert wavesym.summary(scene)["acceleration@40 m"].max.value > 0


def _single_options() -> list[tuple[str, click.Option]]:
    context = click.Context(cli)
    commands = {name: cli.get_command(context, name) for name in COMMANDS}
    return [
        (name, option)
        for name, command in commands.items()
        for option in (command.params if command else ())
        if isinstance(option, click.Option) and not option.is_flag and not option.multiple
    ]


def test_no_option_of_one_value_is_taken_twice(capsys: pytest.CaptureFixture[str]) -> None:
    """The last one counted, in silence; short and long ones are the same option."""
    options = _single_options()
    assert len(options) > 40
    for command, option in options:
        written = [f"{option.opts[0]}=1" if option.opts[0].startswith("--") else f"{option.opts[0]}1"] * 2
        assert main([command, *written]) == 2
        out, error = capsys.readouterr()
        assert (out, error.count("\n")) == ("", 1)
        refusal = f"wavesym {command}: {'/'.join(option.opts)}: written twice, and takes one value; write "
        assert error.startswith(refusal)
    assert main(["generate", "drive_m1", "--runtime", "kappa", "--runtime", "load"]) == 2
    assert "write one list with commas" in capsys.readouterr().err
    assert not list(Path().glob("drive_m1*"))


@pytest.mark.parametrize(("language", "told"), [("c", True), ("numpy", False)])
def test_c_of_modes_says_that_it_is_a_stream(
    language: str, told: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A program after the guide's would not link: it has no eval."""
    scene = tmp_path / "shaken.toml"
    scene.write_text(
        'name = "shaken"\n[system]\ntype = "drive"\nm = 1\nkappa = [1]\ninertia = [1, 1]\ndamping = 0.05\n'
        '[[load]]\nbody = 1\nspacing = "1/4"\nsamples = [0, 1]\n[output]\nuntil = 2\ntolerance = 1e-3\nvelocity = [1]\n'
    )
    assert main(["generate", str(scene), "-o", str(tmp_path), "--language", language]) == 0
    assert ("its C is a stream: shaken_step takes the loads" in capsys.readouterr().err) == told
    assert all("shaken_eval" not in file.read_text() for file in tmp_path.glob("*.h"))


LONG = "/".join(["d" * 200] * 19)
SPACED = "a b " * 50 + "/" + "c " * 100 + "/end"


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", f"{LONG}/end"],
        ["run", SPACED],
        ["record", f"{LONG}/end"],
        ["run", "drive_m1", "--at", f"{LONG}/end"],
        ["run", "drive_m1", "-o", f"{LONG}{'d' * 200}/end"],
        ["run", "drive_m1", "--samples", LONG],
        [LONG],
    ],
    ids=["scene", "scene with blanks", "record", "times", "out", "option", "command"],
)
def test_a_long_path_leaves_room_for_what_is_wrong_with_it(
    capsys: pytest.CaptureFixture[str], arguments: list[str], folder: Path
) -> None:
    """Its beginning and its end are there."""
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert len(error) < 560
    assert "..." in error
    assert "end" in error or not arguments[-1].endswith("end")
    name = arguments[-1].replace("\n", " ")
    assert name[:70] in error


def test_a_path_that_is_not_long_is_whole() -> None:
    name = "d" * 117 + "/" + "e" * 117
    assert name in str(wavesym.SceneError("wrong", file=name))
