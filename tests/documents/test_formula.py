"""Formulas pasted back, into SymPy, a C compiler and as plain text, against what `run` gives."""

from __future__ import annotations

import re
from collections.abc import Callable
from ctypes import CDLL, c_double
from math import exp
from pathlib import Path
from subprocess import run

import numpy as np
import pytest
import sympy

import wavesym
from wavesym.cli import main
from wavesym.errors import CostError, ToleranceError, UnservedError, WavesymError
from wavesym.running.toolchain import at_hand
from wavesym.scene import Scene

TAU = [0.0, 0.3, 0.5, 1.0, 1.25, 2.0, 2.6, 3.999]
SCENES = ["drive_m1", "building_m2", "collision_m4", "drive_equal", "stepped_shaft"]
NAMED = ["drive_m1", "building_m2", "collision_m4", "drive_equal", "building_half_roof"]


def scene(name: str) -> Scene:
    return Scene.from_toml(name).with_({"output.until": 4})


def served(made: Scene, symbolic: bool) -> list[str]:
    names = [output.name for output in made.outputs]
    return [name for name in names if not symbolic or name.partition("@")[0] not in ("acceleration", "force")]


def letters(title: str) -> dict[str, sympy.Rational]:
    return {name: sympy.Rational(value) for name, value in re.findall(r"(\w+) is (\S+?) in the scene", title)}


def assert_agrees(made: Scene, name: str, values: list[float]) -> None:
    """Sums of terms that cancel: their rounding, for numbers of a moderate size."""
    expected = dict(zip((output.name for output in made.outputs), wavesym.run(made, TAU).values, strict=True))[name]
    assert values == pytest.approx(expected, abs=1e-9 * max(1.0, float(np.abs(expected).max())))


@pytest.mark.quick(4)
@pytest.mark.parametrize("symbolic", [False, True])
@pytest.mark.parametrize("name", NAMED)
def test_an_expression_for_sympy_is_the_output(name: str, symbolic: bool) -> None:
    made = scene(name)
    tau = sympy.Symbol("tau")
    output = served(made, symbolic)[-1]
    text = wavesym.formula(made, output, 4, "sympy", symbolic=symbolic)
    values = letters(wavesym.formula(made, output, 4, symbolic=symbolic).splitlines()[0])
    names = {each: getattr(sympy, each) for each in ("Heaviside", "Rational", "Integer", "exp")}
    expression = sympy.sympify(text, {**names, "tau": tau}).subs(values)
    assert expression.free_symbols <= {tau}
    assert_agrees(made, output, [float(expression.subs(tau, sympy.Rational(t)).evalf(30)) for t in TAU])


@pytest.mark.parametrize("name", SCENES)
def test_plain_text_is_the_output(name: str) -> None:
    made = scene(name)
    for output in served(made, False):
        values = []
        text = wavesym.formula(made, output)
        gains = re.findall(r"from tau = (\S+) on, .*:\n    (.*)\n", text)
        for t in TAU:
            total = 0.0
            for start, terms in gains:
                w = t - float(sympy.Rational(start))
                if w >= 0:
                    python = re.sub(r"(?<=[\w)]) (?=[\w(])", "*", terms.replace("^", "**"))
                    total += eval(python, {"exp": exp, "w": w})
            values.append(total)
        assert_agrees(made, output, values)


def compiled(text: str, folder: Path) -> Callable[..., float]:
    source, library = folder / "formula.c", folder / "formula.so"
    source.write_text(text)
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-shared", "-fPIC"]
    run([*at_hand()[0].command, *flags, str(source), "-o", str(library), "-lm"], check=True)
    (function,) = re.findall(r"double (\w+)\(double tau", text)
    call = getattr(CDLL(str(library)), function)
    call.restype = c_double
    return lambda *numbers: call(*(c_double(number) for number in numbers))


@pytest.mark.skipif(not at_hand(), reason="needs gcc or clang")
@pytest.mark.parametrize(("name", "symbolic"), [("drive_m1", False), ("drive_m1", True), ("collision_m4", True)])
def test_a_function_in_c_is_the_output(name: str, symbolic: bool, tmp_path: Path) -> None:
    made = scene(name)
    output = served(made, symbolic)[-1]
    text = wavesym.formula(made, output, 4, "c", symbolic=symbolic)
    values = [float(value) for value in letters(text.splitlines()[0]).values()]
    call = compiled(text, tmp_path)
    assert_agrees(made, output, [call(t, *values) for t in TAU])


@pytest.mark.skipif(not at_hand(), reason="needs gcc or clang")
def test_a_function_in_c_keeps_to_its_bound_and_is_refused_where_terms_cancel(tmp_path: Path) -> None:
    near = {"system.kappa[2]": "1.1999", "load[0].times": [0, "1/3", 2], "output": {"until": 5, "strain": ["1+"]}}
    made = Scene.from_toml("building_m2").with_(near)  # 2 kappa_1 is 1.2
    with pytest.raises(
        ToleranceError, match=r"--format c: loses \d+ digits after tau = 3 \(bound \S+ for strain@1\+\)"
    ):
        wavesym.formula(made, "strain@1+", format="c")
    text = wavesym.formula(made.with_({"output.tolerance": 1e-5}), "strain@1+", format="c")
    (bound,) = re.findall(r"right to (\S+) of its largest value, proved", text)
    call = compiled(text, tmp_path)
    # the doubles beside breakpoints at thirds, too
    taus = [tau for at in np.arange(1, 14) / 3 for tau in (np.nextafter(at, 0), at, np.nextafter(at, 9), at + 0.2)]
    history = wavesym.run(made, [*taus, 5.0])["strain@1+"]
    error = np.abs([call(tau) for tau in [*taus, 5.0]] - history).max() / np.abs(history).max()
    assert 1e-12 < error <= float(bound)  # and much is lost here


@pytest.mark.skipif(not at_hand(), reason="needs gcc or clang")
@pytest.mark.parametrize(("until", "expected"), [(0.5, 0.0), (1.0, 1.0)], ids=["zero", "constant"])
def test_what_does_not_change_is_c_without_a_warning(until: float, expected: float, tmp_path: Path) -> None:
    parts = [{"joint": True, "name": "a"}, {"rod": 1}, "absorbing"]
    load = [{"at": "a", "times": [0], "steps": [1]}]
    output = {"until": until, "velocity": ["3/4"]}
    made = Scene(name="pulse", system={"type": "chain", "parts": parts}, load=load, output=output)
    assert compiled(wavesym.formula(made, "velocity@3/4", format="c"), tmp_path)(until) == expected


def test_a_coefficient_that_is_wrong_is_noticed() -> None:
    made = scene("drive_m1")
    text = wavesym.formula(made, "strain@0", format="sympy").replace("Integer(-8)", "Integer(-9)")
    names = {each: getattr(sympy, each) for each in ("Heaviside", "Rational", "Integer", "exp")}
    tau = sympy.Symbol("tau")
    expression = sympy.sympify(text, {**names, "tau": tau})
    with pytest.raises(AssertionError):
        assert_agrees(made, "strain@0", [float(expression.subs(tau, sympy.Rational(t))) for t in TAU])


def test_latex_has_the_same_terms() -> None:
    text = wavesym.formula(scene("drive_m1"), "strain@0", 2.5, "latex")
    assert r"H(\tau - 1)\left[2\,e^{-(\tau - 1)} - 2\,e^{-\tfrac{1}{2}(\tau - 1)}\right]" in text
    symbolic = wavesym.formula(scene("drive_m1"), "strain@0", 1, "latex", symbolic=True)
    assert r"-1 + e^{-\kappa_{1}\tau}" in symbolic


def test_what_has_no_formula_says_so() -> None:
    made = scene("drive_m1")
    with pytest.raises(WavesymError, match=r"--output: strain@9 is no output of drive_m1; it has strain@0"):
        wavesym.formula(made, "strain@9")
    with pytest.raises(WavesymError, match=r"--until: 5 tau is not between 0 and the horizon, 4 tau$"):
        wavesym.formula(made, "strain@0", 5)
    with pytest.raises(CostError, match=r"--until: \d+ terms, the limit is 2000 \(an earlier one"):
        wavesym.formula(Scene.from_toml("drive_m1").with_({"output.until": 90}), "strain@0")
    with pytest.raises(UnservedError, match="as collision, drive and building have"):
        wavesym.formula(scene("stepped_shaft"), scene("stepped_shaft").outputs[0].name, symbolic=True)
    touching = {"system.contacts": "open", "output.displacement": [0], "output.strain": ["1-"]}
    parting = Scene.from_toml("collision_m4").with_(touching)
    with pytest.raises(UnservedError, match="contact"):
        wavesym.formula(parting, "strain@1-")


@pytest.mark.parametrize(
    ("written", "others"),
    [
        ("strain@0.5", ["strain@1/2", "strain@0.50", "strain@5e-1", "strain@2/4"]),
        ("strain@n-", ["strain@1-", "strain@1.0-", "strain@2/2-"]),
        ("displacement@n", ["displacement@1", "displacement@1.0"]),
        ("force@b:1/4", ["force@b:0.25", "force@b:2.5e-1"]),
    ],
)
def test_a_place_may_be_written_in_any_way(written: str, others: list[str]) -> None:
    system = {"type": "chain", "parts": [{"rod": 1}, {"mass": 1, "name": "n"}, {"rod": 1}, "fixed"]}
    system["branch"] = [{"from": "n", "name": "b", "parts": [{"rod": 1}, "free"]}]
    quantity, _, place = written.partition("@")
    load = [{"at": 0, "times": [0], "steps": [1]}]
    made = Scene(name="s", system=system, load=load, output={"until": 3, quantity: ["3/2", place]})
    expected = wavesym.formula(made, written)
    assert [wavesym.formula(made, each) for each in others] == [expected] * len(others)
    with pytest.raises(WavesymError, match="is no output of s"):
        wavesym.formula(made, f"{quantity}@1/3")


def test_the_command_writes_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["formula", "drive_m1", "--output", "strain@0", "--until", "5/2"]) == 0
    assert capsys.readouterr().out == wavesym.formula(Scene.from_toml("drive_m1"), "strain@0", 2.5)
    out = tmp_path / "out.c"
    assert main(["formula", "drive_m1", "--output", "strain@0", "--format", "c", "-o", str(out)]) == 0
    assert "double drive_m1_strain_0(double tau)" in out.read_text()
    assert main(["formula", "drive_m1", "--output", "strain@0", "--until", "soon"]) == 2
