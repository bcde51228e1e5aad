"""Every program of a scene beside integrations: a fault in any kernel is seen, and named, whatever `generate` takes."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from tests.support.without_compiler import without_compiler
from wavesym import api
from wavesym.cli import main
from wavesym.programs.program import Program
from wavesym.programs.request import Request
from wavesym.running import co_simulation
from wavesym.scene import Scene, lower
from wavesym.targets.files import files, fmu_files
from wavesym.verification import programs, report

SAMPLES = {"spacing": "1/2", "samples": [0, 1, -2, 1, 0]}
DRIVE = Scene(
    name="small",
    system={"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 2]},
    load=[{"body": 1, **SAMPLES}],
    output={"until": 3, "tolerance": "1e-4", "velocity": [1], "displacement": [0]},
)
CHAIN = Scene(
    name="small",
    system={
        "type": "chain",
        "parts": [{"mass": 1, "name": "a"}, {"rod": 1}, {"rod": "1/2", "impedance": 2}, {"mass": 2, "name": "b"}],
    },
    load=[{"at": "a", **SAMPLES}],
    output={"until": 3, "tolerance": "1e-4", "velocity": ["b"], "displacement": ["a"]},
)
FAULTS = {
    "closed.c": (DRIVE, "--evaluator closed", "sum += polynomial", "sum -= polynomial"),
    "closed form in NumPy": (DRIVE, "--evaluator closed", "row[late] += polynomial", "row[late] -= polynomial"),
    "pieces.c": (DRIVE, "--evaluator pieces", "tau - centre[piece]", "tau + centre[piece]"),
    "march.c": (DRIVE, "--evaluator march", "sum += gain[k] * integral_of_wave", "sum -= gain[k] * integral_of_wave"),
    "outputs of march.c": (
        CHAIN,
        "--evaluator march",
        "out[output] += gain[k] * read_wave",
        "out[output] -= gain[k] * read_wave",
    ),
    "modes.c": (DRIVE, "--evaluator modes", "v0[n] * before + v1[n] * now", "v0[n] * before - v1[n] * now"),
    "runtime.c": (DRIVE, "--runtime kappa,load", "+ other[side] * second", "- other[side] * second"),
    "runtime/march.c": (
        CHAIN,
        "--runtime mass,load",
        "below += e->drive[j] * e->acting[j]",
        "below -= e->drive[j] * e->acting[j]",
    ),
    "stream.c": (DRIVE, "--stream", "out[output] += gain[k] * value_now", "out[output] -= gain[k] * value_now"),
    "in single precision": (DRIVE, "--evaluator march --precision single", "sum += gain[k]", "sum -= gain[k]"),
}
PARTS_OF_MODELS = {
    "sample": ("runtime kappa inertia, C, sample", "first + (real)(j * (int)LANES)", "first - (real)(j * (int)LANES)"),
    "estimate": ("kappa inertia, C, others", "return model->estimate;", "return model->estimate * 0;"),
    "what is found between instants": ("C, peaks", "explore(&p, greatest, t[j", "explore(&p, least, t[j"),
    "instants of peaks": ("C, others, peaks", "seen(greatest, found[j], cycle_begin(window) + t[j])", "(void)greatest"),
    "bound": ("C, error_bound", "bound[output] = is_zero[output] ? 0 : known;", "bound[output] = known / 1000000;"),
    "batch": ("C, batch", "batch->series[k][set]", "batch->series[k][set - (set > 0)]"),
    "misfit": ("C, misfit", "none - cells[AIM * ROWS + i]", "none + cells[AIM * ROWS + i]"),
    "gradients": ("C, gradients", "x, degree, 1, moving", "x, degree, 0, moving"),
}
QUICK = ("closed form in NumPy", "closed.c", "outputs of march.c", "runtime.c")


def changing(right: str, wrong: str) -> Callable[..., dict[str, str]]:
    """What writes programs with a fault in their C or in their NumPy."""

    def changed(program: Program, language: str) -> dict[str, str]:
        made = files(program, language)
        assert any(right in text for text in made.values()) or language != ("numpy" if "row" in right else "c")
        return {name: text.replace(right, wrong) for name, text in made.items()}

    return changed


def failing(text: str) -> set[str]:
    """The programs that fail, of the table of programs."""
    block = next(block for block in text.split("\n\n") if block.startswith("scene  program"))
    start = block.index("program")
    end = block.index("  of ")
    return {line[start:end].strip() for line in block.splitlines() if line.endswith("FAIL")}


@pytest.mark.quick(2)
@pytest.mark.parametrize("kernel", [k if k in QUICK else pytest.param(k, marks=pytest.mark.slow) for k in FAULTS])
def test_a_fault_is_seen_and_its_program_named(
    kernel: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, options, right, wrong = FAULTS[kernel]
    monkeypatch.setattr(programs, "files", changing(right, wrong))
    (tmp_path / "small.toml").write_text(toml(scene))
    assert main(["verify", str(tmp_path / "small.toml"), *options.split()]) == 1
    found = failing(capsys.readouterr().out)
    assert found
    languages = ("NumPy",) if "NumPy" in kernel else ("C", "FMI 2", "FMI 3")  # an FMU has the same C
    assert all(
        name.endswith(tuple(f", {language}" for language in languages)) or f", {languages[0]}," in name
        for name in found
    )


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "parts",
    [
        ["sample"],
        ["what is found between instants", "bound", "batch", "misfit", "gradients"],
        pytest.param(["estimate"], marks=pytest.mark.slow),
        pytest.param(["instants of peaks"], marks=pytest.mark.slow),
    ],
    ids=lambda parts: parts[-1],
)
def test_a_fault_in_what_a_model_gives_is_seen(parts: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """In `sample`, peaks and all else that `eval` knows nothing of: each in its own row."""

    def faulty(program: Program, language: str) -> dict[str, str]:
        made = files(program, language)
        for _, right, wrong in map(PARTS_OF_MODELS.__getitem__, parts):
            assert any(right in text for text in made.values())
            made = {name: text.replace(right, wrong) for name, text in made.items()}
        return made

    monkeypatch.setattr(programs, "files", faulty)
    text, passed = report.verify([(DRIVE, lower(DRIVE))], [Request(runtime=("kappa", "inertia"))])
    assert not passed
    for where, _, _ in map(PARTS_OF_MODELS.__getitem__, parts):
        assert any(name.endswith(where) for name in failing(text))
    if len(parts) > 1:
        assert not [name for name in failing(text) if name.endswith((", C", "sample", "sample backwards", "others"))]


@pytest.mark.quick(1)
@pytest.mark.parametrize("runtime", [(), ("kappa", "inertia")], ids=["fixed", "tuned"])
@pytest.mark.parametrize("wrong", ["0 * most", "most / (most - most)"], ids=["nothing", "no number"])
def test_a_stream_that_hides_what_it_has_lost_is_seen(
    wrong: str, runtime: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(programs, "files", changing("most = sum / state->largest[output];", f"most = {wrong};"))
    text, passed = report.verify([(DRIVE, lower(DRIVE))], [Request(stream=True, runtime=runtime)])
    assert not passed
    assert failing(text)


def test_what_a_stream_says_is_of_its_outputs_under_the_loads_of_the_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    """In units they are far below what its degree was judged by: an error of a millionth passed."""
    storey = {"count": 2, "height": "3.5 m", "stiffness": "678 MN/m", "column_mass": "2.66 t", "floor_mass": "35 t"}
    scene = Scene(
        name="small",
        units={"length": "mm"},
        system={"type": "building", "base": "ground", "storey": [storey]},
        load=[{"spacing": "0.001 s", "samples": [0, 1, -1, "1/2", 0], "unit": "m/s^2"}],
        output={"until": "0.008 s", "tolerance": 1e-9, "velocity": [1], "drift": [1]},
    )
    text, passed = report.verify([(scene, lower(scene))], [Request(stream=True)])
    assert passed, text
    right = "out[output] += gain[k] * value_now(state, k)"
    monkeypatch.setattr(programs, "files", changing(right, f"{right} * (real)(1 + 1e-6)"))
    text, passed = report.verify([(scene, lower(scene))], [Request(stream=True)])
    assert "stream, C" in failing(text)


JUMPS = {"body": 1, "times": [0, "3/4"], "steps": [1, -2]}
RAMPS = {"body": 1, "times": [0, "3/4"], "steps": [1, 0], "ramps": [1, -2]}
FAULTS_OF_FMUS = {
    "loads that are held": ([JUMPS], (), "if (!s->now.linear)", "if (s->now.linear)"),
    "a jump at the start": (
        [RAMPS],
        (),
        "stream_step(&s->now.stream, 0,",
        "stream_step(&s->trial, 0,",
    ),
    "equal steps": ([{"body": 1, **SAMPLES}], ("kappa",), "STEP_LENGTH, load", "STEP_LENGTH, from"),
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("fault", FAULTS_OF_FMUS)
def test_fmus_are_verified_and_a_fault_in_one_is_seen(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The C beside them is right: what simulators call it by is not."""
    load, runtime, right, wrong = FAULTS_OF_FMUS[fault]
    scene = DRIVE.with_({"load": load})
    requests = [Request(stream=True, runtime=runtime), *([Request("modes")] if runtime else [])]
    text, passed = report.verify([(scene, lower(scene))], requests)
    assert passed, text
    assert text.count("FMI 2  ") == text.count("FMI 3  ") == len(requests)

    def faulty(program: Program, version: str) -> dict[str, str]:
        made = fmu_files(program, version)
        assert right in made["sources/simulation.h"]
        return made | {"sources/simulation.h": made["sources/simulation.h"].replace(right, wrong)}

    monkeypatch.setattr(co_simulation, "fmu_files", faulty)
    text, passed = report.verify([(scene, lower(scene))], requests)
    assert not passed
    assert failing(text)
    assert all(name.endswith(("FMI 2", "FMI 3")) for name in failing(text))


def test_loads_that_no_fmu_takes_are_said_to_be() -> None:
    scene = DRIVE.with_({"load": [RAMPS | {"steps": [1, 1]}]})
    text, passed = report.verify([(scene, lower(scene))], [Request(stream=True)])
    assert passed, text
    assert "not stream, FMI 2; not stream, FMI 3: loads jump after tau = 0 and go in straight lines" in text


def toml(scene: Scene) -> str:
    """A scene as a file; JSON's values are TOML's here."""
    fields = scene.model_dump(mode="json")
    lines = [f"name = {json.dumps(fields['name'])}", f"system = {_inline(fields['system'])}"]
    lines += [f"load = [{', '.join(map(_inline, fields['load']))}]", f"output = {_inline(fields['output'])}"]
    return "\n".join(lines)


def _inline(value: object) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_inline(each)}" for key, each in value.items() if each is not None) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    return json.dumps(value)


@pytest.mark.slow
def test_all_programs_of_a_scene_are_there_and_right() -> None:
    for scene in (DRIVE, CHAIN):
        text, passed = api.verify([scene])
        assert passed, text
        block = next(block for block in text.split("\n\n") if block.startswith("scene  program"))
        kinds = ["run", "closed, NumPy", "closed, C", "pieces, NumPy", "pieces, C", "march, NumPy", "march, C"]
        kinds += [
            "modes, NumPy",
            "modes, C",
            "pieces, single, C",
            "march, single, C",
            "stream, C",
            "stream, FMI 3",
            ", C, others",
        ]
        kinds += [", C, sample", ", C, peaks", ", C, others, peaks", ", C, gradients", ", C, batch", ", C, misfit"]
        for kind in kinds:
            assert f"{kind}  " in block, kind
        numbers = "kappa inertia load" if scene is DRIVE else "velocity load mass impedance"
        assert f"runtime {numbers}, C  " in block


def test_what_is_asked_for_alone_is_compared() -> None:
    text, passed = api.verify([DRIVE], "closed")
    assert passed
    assert (text.count("closed, NumPy"), text.count("closed, C"), text.count("march, C")) == (1, 1, 0)
    assert "Collocation between fronts" in text  # which says how well it agrees with exact values
    assert "the midpoint rule" not in text


def test_a_program_that_does_not_serve_is_not_verified() -> None:
    stepped = DRIVE.with_({"load": [{"body": 1, "times": [0], "steps": [1]}]})
    text, passed = api.verify([stepped], "modes")
    assert not passed
    assert "small: not modes: load: M1 jumps by 1 at tau = 0" in text
    assert "small: no program is verified" in text


def test_without_a_compiler_it_is_said_which_programs_were_not_tried() -> None:
    with without_compiler():
        text, passed = api.verify([DRIVE], "closed")
        assert passed
        assert "C was not tried: no C compiler" in text
        assert "small: not closed, C: there is no C compiler" in text
        text, passed = api.verify([DRIVE], runtime=["kappa"])
        assert not passed  # there is no NumPy of it
        assert "no program is verified" in text


def test_an_output_that_no_integration_judges_is_not_verified(monkeypatch: pytest.MonkeyPatch) -> None:
    checks = [check for check in report.CHECKS if check.run.__name__ == "invariants"]
    monkeypatch.setattr(report, "CHECKS", checks)
    text, passed = report.verify([(DRIVE, lower(DRIVE))], [Request("closed")])
    assert not passed
    assert "small: velocity@1 is not verified, as no integration is exact enough to judge it" in text


def test_an_output_that_does_not_move_before_an_integration_ends_is_not_judged_by_it() -> None:
    """A wave that comes after tau = 2 to where an integration saw nothing until then."""
    late = DRIVE.with_({"output.displacement": [], "output.velocity": [1], "load": [{"body": 1, **SAMPLES}]})
    truth = report.known_outputs(lower(late))
    outcomes = [check.run(truth) for check in report.CHECKS if check.run.__name__ == "midpoints"]
    (integral,) = (outcome.integral for found in outcomes for outcome in found)
    assert integral is not None
    assert report._judges(integral, truth)
    early = programs.IntegratedOutput(integral.taus[:5], 0 * integral.values[:5], 0.0)
    assert not report._judges(early, truth)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--stream", "--evaluator", "march"], "--evaluator: march does not go with --stream; write auto"),
        (["--runtime", "speed"], "--runtime: speed is unknown; write kappa, inertia or load"),
        (["--published", "--stream"], "of scenes only; leave it out, or --published"),
    ],
)
def test_a_wrong_request_is_one_line(options: list[str], says: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", *([] if "--published" in options else ["drive_m1"]), *options]) == 2
    out, told = capsys.readouterr()
    assert out == ""
    assert says in told
    assert "Traceback" not in told
