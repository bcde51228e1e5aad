"""What C with parameters at run time has besides values: what is asked for alone; and how light bodies may be."""

import json
import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import wavesym
from tests.support.builds import LANGUAGES, STRICT, needs_binutils, sections
from tests.support.built_model import BuiltModel
from tests.targets.test_runtime_c import BUILDING, COLLISION
from tests.targets.test_runtime_memory import stated
from wavesym.cli import main
from wavesym.programs.request import PARTS, Request
from wavesym.programs.runtime.making import runtime_program
from wavesym.running.toolchain import compiler
from wavesym.scene import lower
from wavesym.scene.lowering import amplitudes
from wavesym.targets.files import files

SMALL = BUILDING.with_({"name": "small", "load": [{"times": [0], "a": [1]}], "output": {"until": 2, "drift": [1]}})
CHAIN = wavesym.Scene.from_toml("stepped_shaft").with_({"output.until": 2})
SCENES = {"building": (SMALL, ["kappa", "load"]), "chain": (CHAIN, ["mass"])}
"""Of the chain derivatives are made of products, values are not."""
VALUES = {"build", "build_with", "error_estimate", "model_eval", "model_sample"}
MORE = {
    "peaks": {"model_peaks"},
    "gradients": {"build_tangent", "tangent_estimate", "tangent_sample"},
    "batch": {"build_batch", "batch_model"},
    "misfit": {"build_batch", "batch_model", "data_size", "data_init", "batch_misfit"},
    "bound": {"error_bound", "error_bound_with"},
}
OF_BOUNDS = re.compile(
    r"^ +for [^\n]*\{\n[^\n]*->(?:weight|impedance)\b[^\n]*\n +\}\n|^ +(?:law|values)->(?:weight|impedance)\b[^\n]*\n",
    re.MULTILINE,
)
"""Where they have their laws."""
CHOICES = [(), ("misfit",), *((part,) for part in PARTS if part != "misfit"), ("bound", "peaks"), PARTS]


def functions(text, name):
    """Those that a header declares."""
    return set(re.findall(rf"\b{name}_(\w+)\(", re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)))


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", SCENES)
def test_there_is_what_is_asked_for_and_nothing_else(case):
    scene, runtime = SCENES[case]
    program = runtime_program(lower(scene), Request(runtime=tuple(runtime)), amplitudes(scene))

    def files_of(parts):
        request = Request(runtime=tuple(runtime), parts=parts)
        origin = replace(program.provenance, options=request.options())
        return files(replace(program, parts=request.every_part, provenance=origin))

    every = files_of(PARTS)[f"{scene.name}.c"]
    for parts in CHOICES:
        made = files_of(parts)
        header, source = made[f"{scene.name}.h"], made[f"{scene.name}.c"]
        wanted = VALUES.union(*(MORE[part] for part in parts))
        assert functions(header, scene.name) == functions(source, scene.name) == wanted
        # values are computed by the same C, whatever there is besides; masses and impedances are laws of bounds alone
        for function in re.findall(r"^[a-z][^;{}]*\)\n\{\n.*?^\}", source, re.DOTALL | re.MULTILINE):
            assert function in every or ("bound" not in parts and function in OF_BOUNDS.sub("", every))
        named = f" --with {','.join(parts)}" if parts else ""
        assert f"--runtime {','.join(runtime)}{named}\n" in header
        told = json.loads(made[f"{scene.name}.json"])
        assert set(told["with"]) == set(parts) | ({"batch"} if "misfit" in parts else set())
        assert told["command"].endswith(f"--runtime {','.join(runtime)}{named}")


@pytest.mark.slow
@pytest.mark.parametrize("language", ["c99", "c++17"])
@pytest.mark.parametrize("parts", CHOICES, ids=lambda parts: "-".join(parts) or "values")
@pytest.mark.parametrize("case", SCENES)
def test_each_choice_compiles_without_a_warning(case, parts, language, tmp_path):
    scene, runtime = SCENES[case]
    wavesym.generate(scene, tmp_path, runtime=runtime, parts=parts)
    for file in (f"{scene.name}.c", f"{scene.name}_selftest.c"):
        compiler().run([*LANGUAGES[language], *STRICT, "-O1", "-c", file, "-o", f"{file}.o"], tmp_path)
        assert (tmp_path / f"{file}.o").stat().st_size  # a warning is an error, which `run` raises


@pytest.mark.slow
@needs_binutils
@pytest.mark.parametrize("precision", ["double", "single"])
def test_values_alone_are_small(precision, tmp_path):
    """Two storeys to 12 at 1e-8: 78 KB of code and 158 KB of model before."""
    scene = wavesym.Scene.from_toml("building_m2")
    wavesym.generate(scene, tmp_path, runtime=["kappa"], precision=precision)
    compiler().run(["-std=c99", "-Os", "-c", "building_m2.c", "-o", "made.o"], tmp_path)
    text = sum(size for name, size in sections(tmp_path / "made.o").items() if name.startswith(".text"))
    assert text < 20_000
    assert stated(tmp_path, "building_m2")[0]["building_m2_model, of each set of parameters that is kept"] < (
        40_000 if precision == "double" else 20_000
    )


def model_size(scene, folder, kappa_max):
    wavesym.generate(scene, folder, runtime=["kappa"], kappa_max=kappa_max, force=True)
    return next(iter(stated(folder, scene.name)[0].values())), json.loads((folder / f"{scene.name}.json").read_text())


def test_a_smaller_kappa_makes_a_smaller_model(tmp_path):
    sizes = [model_size(SMALL, tmp_path, each and Fraction(each)) for each in (1, None, 20, 100)]
    # ten times the largest of the scene, unless it is said
    assert [told["kappa_max"] for _, told in sizes] == [1, 6, 20, 100]
    assert sorted(size for size, _ in sizes) == [size for size, _ in sizes]
    assert sizes[0][0] < sizes[-1][0] / 3
    # less than the scene has is taken as that
    assert model_size(SMALL, tmp_path, Fraction(1, 1000))[1]["degree"] <= sizes[0][1]["degree"]


@pytest.mark.slow
@pytest.mark.parametrize("largest", [1, 4, 40])
@pytest.mark.parametrize("scene", [wavesym.Scene.from_toml("bench/c.toml"), BUILDING, COLLISION], ids=lambda s: s.name)
def test_every_set_up_to_the_largest_kappa_is_taken_and_far_beyond_it_none(scene, largest, tmp_path):
    """In the first one waves cancel where bodies are equal."""
    made = BuiltModel(scene, ["kappa"], tmp_path, kappa_max=largest)
    count, random = len(scene.system.kappa), np.random.default_rng(3)
    for _ in range(100):
        assert made.build(*largest * 10.0 ** -random.uniform(0, 3, count)) == 0
        assert made.build(*np.where(random.random(count) < 0.5, largest, largest * random.uniform(0, 1, count))) == 0
        assert made.build(*[4 * largest] * count) == 2


def test_a_chain_has_rates(tmp_path):
    wavesym.generate(CHAIN, tmp_path, runtime=["mass"])
    usual = json.loads((tmp_path / "stepped_shaft.json").read_text())
    assert usual["reason"].endswith("for rates up to 10; errors are estimated")
    wavesym.generate(CHAIN, tmp_path, runtime=["mass"], kappa_max=Fraction(1, 2))
    assert json.loads((tmp_path / "stepped_shaft.json").read_text())["degree"] < usual["degree"]
    assert "for rates up to 1;" in (tmp_path / "stepped_shaft.h").read_text()  # that of the scene


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--with", "peaks"], "--with: peaks goes with --runtime only; leave --with out"),
        (["--kappa-max", "3"], "--kappa-max: 3 goes with --runtime only; leave --kappa-max out"),
        (
            ["--runtime", "kappa", "--with", "peak"],
            'peak is unknown; write peaks, gradients, .*. Did you mean "peaks"?',
        ),
        (["--runtime", "kappa", "--with", "bound,bound"], "--with: bound stands twice; write it once"),
        (
            ["--runtime", "kappa", "--with", ""],
            "--with: an empty name is unknown; write peaks, gradients, batch, misfit or bound",
        ),
        (["--runtime", "kappa", "--stream", "--with", "peaks"], "--with: peaks does not go with --stream; leave"),
        (
            ["--runtime", "kappa", "--target", "fmu2", "--kappa-max", "3"],
            "--kappa-max: 3 does not go with --target fmu2",
        ),
        (["--runtime", "load", "--kappa-max", "3"], "--kappa-max: 3 with --runtime load: bodies stay as heavy"),
        (["--runtime", "kappa", "--kappa-max", "0"], "0 is not a positive number; write one such as 5 or 1/2"),
        (["--runtime", "kappa", "--kappa-max", "nan"], "nan is not a positive number; write one such as 5 or 1/2"),
        (["--runtime", "kappa", "--kappa-max", "1e9"], "for kappa up to 1e.09 need .* a smaller --kappa-max, helps"),
    ],
)
def test_what_means_nothing_is_refused_in_one_line(options, told, tmp_path, capsys):
    assert main(["generate", "building_m2", "-o", str(tmp_path / "none"), *options]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert re.search(told, err)
    assert not (tmp_path / "none").exists()


@pytest.mark.slow
def test_check_compares_with_what_was_asked_for(tmp_path, capsys):
    folder = str(tmp_path / "made")
    asked = ["generate", "building_m2", "-o", folder, "--runtime", "kappa", "--with", "peaks", "--kappa-max", "5/2"]
    assert main(asked) == 0
    assert main([*asked, "--check"]) == 0
    assert main([*asked[:-2], "--check"]) == 1
    assert main([*asked[:6], "--with", "peaks,bound", "--kappa-max", "5/2", "--check"]) == 1
    assert "--with peaks,bound --kappa-max 5/2" in capsys.readouterr().out
