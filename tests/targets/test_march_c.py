"""The march in C: strict compilers take it, it gives what NumPy gives, and it can be driven window by window."""

import shlex
import subprocess
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from tests.support.builds import STRICT, needs_binutils
from tests.support.generated import numpy_text, program_files
from tests.support.patience import first_always
from wavesym.numbers.doubles import fraction, nearest
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.march.evaluator import marched
from wavesym.running.compiled import FLAGS, compiled, imported
from wavesym.running.toolchain import at_hand
from wavesym.scene import Scene, lower

COMPILERS = first_always(at_hand())


def scene(system, load=(), until=9, **outputs):
    output = {"until": until, "tolerance": "1e-3", **outputs}
    return Scene(name="made", system=system, load=list(load), output=output)


def building(base, until=9):
    system = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": base}
    load = {"times": [0, "1/3", "5/2"], "a": [1, 0, "-1/2"], "b": ["-1/4", "1/2", 0]}
    return scene(system, [load], until, strain=["1/3", "1+"], velocity=[0, 2], displacement=["1/2", 1])


DRIVE = scene(
    {"type": "drive", "m": 2, "kappa": [1, "1/2"], "inertia": [1, 2, 1]},
    [{"body": 1, "times": [0, "1/3"], "steps": [1, -2]}, {"body": 3, "times": ["5/2"], "steps": [1]}],
    strain=[0, "1-"],
    velocity=["5/3"],
    displacement=[2],
)
COLLISION = scene(
    {"type": "collision", "m": 4, "kappa": ["1/10", "2"], "velocity": [1, "-1/2"]},
    strain=[0, "1-", 2],
    velocity=["1/2"],
    displacement=[4],
)
SCENES = pytest.mark.parametrize(
    "scene", [building("force"), building("ground"), DRIVE, COLLISION], ids=["force", "ground", "drive", "collision"]
)


def sources(scene, made):
    return program_files(lower(scene), made, "c")


def with_selftest(scene, made):
    """With the self-test."""
    return program_files(lower(scene), made, "c", tested=True)


@pytest.mark.parametrize("compiler", COMPILERS, ids=lambda each: each.name)
@pytest.mark.parametrize("real", [DOUBLE, SINGLE], ids=["double", "single"])
@SCENES
def test_c_passes_its_self_test(scene, real, compiler, monkeypatch):
    monkeypatch.setenv("CC", shlex.join(compiler.command))
    with compiled(with_selftest(scene, marched(lower(scene), real)), len(scene.outputs)) as program:
        assert program.selftest() == 0


@SCENES
def test_c_is_numpy_and_sample_is_eval(scene):
    made = marched(lower(scene))
    module = imported(numpy_text(lower(scene), made), "made")
    taus = [0.0, 1 / 3, 0.9999, 1.0, 2.5, 2.4999999999999996, 5.7, 8.999999, 9.0, -1.0, 9.1, float("nan")]
    with compiled(with_selftest(scene, made), len(scene.outputs)) as program:
        assert program.names == module.OUTPUTS
        values = program(taus)
        expected = module.evaluate(taus)
        assert np.isnan(expected[:, 9:]).all()
        sizes = np.nanmax(np.abs(expected), axis=1, keepdims=True)
        # rounding differs, and no more; where a jump is, both stand on the same side of it
        assert (np.isnan(values) == np.isnan(expected)).all()
        assert np.nanmax(np.abs(values - expected) - 1e-14 * sizes) <= 0
        for tau0, dtau, count in ((0.0, 0.01, 901), (9.0, -0.37, 30), (-1.0, 1.0, 12)):
            status, sampled = program.sample(tau0, dtau, count)
            single = program([tau0 + k * dtau for k in range(count)])
            np.testing.assert_array_equal(sampled, single)
            assert status == int(np.isnan(single).any())


DRIVER = """
#include "made.h"
#include <stdio.h>

enum { TIMES = 3, LOADS = MADE_SOURCES * MADE_POINTS };

/* Loads from a file, window by window; values to another one. Returns what the last advance returned. */
int main(int count, char **names)
{
    static made_state state;
    static double loads[LOADS + 1];
    const double times[TIMES] = {0.0, 0.4, 0.75};
    FILE *const from = count > 2 ? fopen(names[2], "rb") : NULL;
    FILE *const to = fopen(names[1], "wb");
    int status = 0;
    made_init(&state);
    double out[MADE_OUTPUTS];
    if (!to || made_read(&state, 0.0, out) != 1) {
        return 2;
    }
    while (state.window + 1 < (int)MADE_TAU_MAX) {
        if (from && fread(loads, sizeof *loads, LOADS, from) != LOADS) {
            return 2;
        }
        status = made_advance(&state, from ? loads : NULL);
        for (int k = 0; k < TIMES; ++k) {
            if (made_read(&state, state.window + times[k], out) != 0) {
                return 2;
            }
            fwrite(out, sizeof *out, MADE_OUTPUTS, to);
        }
        if (made_read(&state, state.window + 1.0, out) != 1) {
            return 2;
        }
    }
    const double energy = made_energy(&state);
    fwrite(&energy, sizeof energy, 1, to);
    return fclose(to) == 0 ? status : 2;
}
"""


def driven(folder, scene, made, loads=None, compiler=COMPILERS[0]):
    """Status, energy, and the outputs at 0, 0.4 and 0.75 after the start of every window."""
    for name, text in {**sources(scene, made), "driver.c": DRIVER}.items():
        (folder / name).write_text(text)
    compiler.run([*FLAGS, "driver.c", "made.c", "-o", "driver"], folder)
    command = [folder / "driver", "out.bin"]
    if loads is not None:
        loads.tofile(folder / "loads.bin")
        command.append("loads.bin")
    status = subprocess.run(command, cwd=folder, check=False).returncode
    found = np.fromfile(folder / "out.bin")
    return status, found[-1], found[:-1].reshape(-1, len(scene.outputs)).T


def given(scene, made):
    """The scene's own loads at the points of all windows; at a panel's ends from inside."""
    cuts = [Fraction(0), Fraction(1, 3), Fraction(1, 2), Fraction(1)]
    assert [Fraction(str(panel.start)) for panel in made.plan.panels] == cuts[:-1]
    names = [channel.name for channel in made.plan.channels]
    rows = []
    for window in range(int(made.tau_max)):
        for name in names:
            for low, high in pairwise(cuts):
                x = float(low) + float(high - low) * (1 - np.cos(np.pi * np.arange(made.degree + 1) / made.degree)) / 2
                values = np.zeros_like(x)
                for piece in lower(scene).loads:
                    if fraction(piece.time) <= window + low and piece.source in (name, "b" if name == "a" else ""):
                        since = window + x - nearest(piece.time)
                        values += nearest(piece.weight) * (since if piece.source == "b" else 1)
                rows.append(values)
    return np.array(rows)


@pytest.mark.parametrize("scene", [building("force"), building("ground"), DRIVE], ids=["force", "ground", "drive"])
def test_loads_given_while_it_runs_do_what_the_scene_does(scene, tmp_path):
    made = marched(lower(scene))
    status, energy, own = driven(tmp_path, scene, made)
    assert status == 0
    assert energy > 0
    again, same_energy, values = driven(tmp_path, scene, made, given(scene, made))
    assert again == 0
    assert same_energy == pytest.approx(energy, rel=1e-12)
    sizes = np.abs(own).max(axis=1, keepdims=True)
    assert np.abs(own).min(axis=0).max() > 0
    np.testing.assert_allclose(values / sizes, own / sizes, rtol=0, atol=1e-13)


def test_a_degree_that_is_too_low_is_reported(tmp_path):
    long = building("force", until=400)
    status, _, values = driven(tmp_path, long, marched(lower(long), degree=9))
    assert status == 1
    assert np.isfinite(values).all()
    fine = marched(lower(long))
    status, _, _ = driven(tmp_path, long, fine)
    assert status == 0
    # loads that come too fast for the degree are reported as well
    shape = int(fine.tau_max), len(fine.plan.panels), fine.degree + 1
    status, _, _ = driven(tmp_path, long, fine, np.where(np.arange(fine.degree + 1) % 2, 1.0, -1.0) * np.ones(shape))
    assert status == 1


@needs_binutils
@SCENES
def test_it_is_cpp_too_and_exports_only_its_prefix(scene, tmp_path):
    for name, text in sources(scene, marched(lower(scene))).items():
        (tmp_path / name).write_text(text)
    COMPILERS[0].run(["-x", "c++", "-std=c++11", *STRICT, "-c", "made.c", "-o", "made.o"], tmp_path)
    listed = subprocess.run(["nm", "-g", "made.o"], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    symbols = [line.split() for line in listed.splitlines()]
    assert {name for *_, kind, name in symbols if kind != "U"} == {
        f"made_{name}" for name in ("advance", "energy", "eval", "init", "output_name", "point", "read", "sample")
    }
    # tables are read-only: nothing in .data or .bss
    assert not [name for *_, kind, name in symbols if kind in "BbDd"]


CONE_DRIVER = """
#include "made.h"
#include <stdio.h>

int main(void)
{
    static made_state state;
    double out[MADE_OUTPUTS];
    int status = 0;
    made_init(&state);
    while ((status = made_advance(&state, NULL)) == 0 && state.window < 50) {
    }
    printf("%d %d %d %d\\n", status, state.window, made_read(&state, state.window + 0.0, out),
           made_read(&state, state.window + 0.75, out));
    return 0;
}
"""


@pytest.mark.parametrize(
    ("m", "windows", "told"),
    # what is whole goes on; else it ends with the horizon, 5/2, or with the windows that were asked for
    [(2, None, "0 50 0 0"), (9, None, "2 2 0 1"), (9, 5, "2 4 0 0"), (9, 60, "0 50 0 0")],
)
def test_a_march_ends_where_what_is_not_modelled_would_be_felt(m, windows, told, tmp_path):
    system = {"type": "building", "m": m, "kappa": ["1/100"] * (m + 1), "base": "ground"}
    tall = scene(system, [{"times": [0], "a": [1], "b": [0]}], until="5/2", velocity=[1])
    for name, text in {**sources(tall, marched(lower(tall), windows=windows)), "driver.c": CONE_DRIVER}.items():
        (tmp_path / name).write_text(text)
    COMPILERS[0].run([*FLAGS, "driver.c", "made.c", "-o", "driver"], tmp_path)
    assert subprocess.run([tmp_path / "driver"], capture_output=True, text=True, check=True).stdout.strip() == told
