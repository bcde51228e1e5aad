"""The self-test sees every number of the tables that is off by what moves an output beyond its bound.

The library and its self-test are compiled into one, the tables writable, so that each number can be changed and the
self-test run again. How far a change moves the outputs is measured on a grid of its own, not where the self-test looks.
"""

from __future__ import annotations

import ctypes
import json
import re
import subprocess
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq

from tests.support.builds import scene
from tests.support.generated import files
from tests.support.truth import Truth
from wavesym.programs import form as program_form
from wavesym.running.compilation import FLAGS
from wavesym.running.toolchain import compiler
from wavesym.scene import Scene, lower

SAMPLES = 2001
# no wave arrives there, so that every coefficient has time to act
UNTIL = 5.75
# A change is to be seen that moves an output by more than this many bounds: one for what is allowed, and one for the
# error that is there already, which may point the other way.
SEEN = 2.05
NUMBERS = r"static const (?:real|double|float) (\w+)\[\] = \{(.*?)\}"
QUIET = ("#include <stdio.h>", "static void quiet(const char *text, ...) { (void)text; }")


def tables(text):
    """The tables of real numbers in a C file: their names and lengths."""
    return {name: numbers.count(".") for name, numbers in re.findall(NUMBERS, text, re.DOTALL)}


@dataclass
class Mutable:
    """A program whose tables can be changed while it is loaded."""

    library: ctypes.CDLL
    name: str
    real: type
    tau_max: float
    allowed: np.ndarray
    lengths: dict[str, int]

    def table(self, name):
        return (self.real * self.lengths[name]).in_dll(self.library, name)

    def outputs(self):
        """All outputs on a grid, its last point the end of the horizon: shape (outputs, SAMPLES + 1)."""
        sample = getattr(self.library, f"{self.name}_sample")
        sample.argtypes = [self.real, self.real, ctypes.c_size_t, ctypes.c_void_p]
        dtype = np.dtype(self.real)
        apart = np.nextafter(dtype.type(self.tau_max / (SAMPLES - 1)), dtype.type(0))
        inner = np.empty((len(self.allowed), SAMPLES), dtype)
        end = np.empty((len(self.allowed), 1), dtype)
        sample(0.0, apart, SAMPLES, inner.ctypes.data)
        sample(self.tau_max, 0.0, 1, end.ctypes.data)
        return np.hstack([inner, end]).astype(float)

    def moved(self, right):
        """How far the outputs are from what they were, in bounds; infinite where one is no number."""
        return float(np.max(np.abs(np.nan_to_num(self.outputs() - right, nan=np.inf)) / self.allowed[:, np.newaxis]))

    def passes(self):
        return self.library.selftest() == 0


def mutable(evaluator, precision, tolerance, folder):
    return opened(files(lower(scene("small", tolerance, UNTIL)), "c", evaluator, precision), precision, folder)


def opened(made, precision, folder):
    """The files of a program named small, compiled."""
    lengths = tables(made["small.c"])
    writable = re.sub(r"static const (real|double|float) (\w+)\[\]", r"\1 \2[]", made["small.c"])
    (folder / "small.h").write_text(made["small.h"])
    (folder / "small.c").write_text(writable)
    (folder / "small_selftest.c").write_text(made["small_selftest.c"].replace(*QUIET).replace("printf(", "quiet("))
    compiler().run(
        [
            "-O2",
            "-ffp-contract=off",
            "-Dmain=selftest",
            "-fPIC",
            "-shared",
            "small.c",
            "small_selftest.c",
            "-o",
            "small.so",
            "-lm",
        ],
        folder,
    )
    allowed = re.search(r"allowed\[\] = \{(.*?)\}", made["small_selftest.c"], re.DOTALL)
    return Mutable(
        ctypes.CDLL(str(folder / "small.so")),
        "small",
        ctypes.c_double if precision == "double" else ctypes.c_float,
        json.loads(made["small.json"])["tau_max"],
        np.array([float(number) for number in allowed[1].split(",")]),
        lengths,
    )


def response(program, table, place, right):
    """Bounds that an output moves by for a change of 1, by a change that moves it by about 30."""
    value = table[place]
    change = 1e-3 * max(abs(value), 1e-3)
    for _ in range(4):
        table[place] = value + change
        found = program.moved(right) / (table[place] - value)
        table[place] = value
        change = 30 / found if found > 0 else 1e6 * change
    return found


def statuses(made, right, wrong, folder):
    """What the self-test returns with a text of the program as it is, and replaced."""
    assert right in made["small.c"]
    found = []
    for text in (made["small.c"], made["small.c"].replace(right, wrong)):
        for name, content in {**made, "small.c": text}.items():
            (folder / name).write_text(content)
        compiler().run([*FLAGS, "small.c", "small_selftest.c", "-o", "selftest", "-lm"], folder)
        found.append(subprocess.run([folder / "selftest"], capture_output=True, check=False).returncode)
    return found


CASES = [
    ("closed", "double", "1e-12"),
    ("pieces", "double", "1e-12"),
    pytest.param("closed", "single", "1e-3", marks=pytest.mark.slow),
    pytest.param("pieces", "single", "1e-4", marks=pytest.mark.slow),
]
# what a march computes its waves with; `from`, where one polynomial ends and the next begins, is none of it
WAVES = ("half_length", "since", "matrix", "push", "ratio", "initial_state", "event_power", "start", "excess")


def unseen(program, name, right):
    """The places of a table at which a change that moves an output beyond its bound goes unseen."""
    table = program.table(name)
    found = []
    for place, value in enumerate(table):
        per_change = response(program, table, place, right)
        assert per_change > 0, (name, place)
        for sign in (1, -1):
            table[place] = value + sign * SEEN / per_change
            if program.passes():
                found.append((place, value, table[place]))
        table[place] = value
    return found


@pytest.mark.quick(1)
@pytest.mark.parametrize(("evaluator", "precision", "tolerance"), CASES)
def test_every_coefficient_matters_to_it(evaluator, precision, tolerance, tmp_path):
    program = mutable(evaluator, precision, tolerance, tmp_path)
    right = program.outputs()
    assert program.passes()
    for name in ("coefficient", "rate") if evaluator == "closed" else ("coefficient",):
        assert program.lengths[name] > 10
        assert unseen(program, name, right) == []
    assert program.passes()


@pytest.mark.slow
def test_an_edit_of_a_chain_is_seen_where_a_value_leaves_the_bound(tmp_path):
    """Of the chain in the guide: how many are, grows with the edit; what passes has moved no output further."""
    guide = (Path(__file__).parents[2] / "docs" / "guide" / "chains.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"```toml lift\.toml\n(.*?)```", guide, re.DOTALL)
    (tmp_path / "lift.toml").write_text(text, encoding="utf-8")
    lift = replace(lower(Scene.from_toml(tmp_path / "lift.toml")), name="small", tolerance=fmpq(1, 10**10))
    program = opened(files(lift, "c", "pieces"), "double", tmp_path)
    right, table, seen = program.outputs(), program.table("coefficient"), []
    for edit in (1e-9, 1e-6, 1e-3):
        seen.append(0)
        for place, value in enumerate(table):
            table[place] = value * (1 + edit)
            if program.passes():
                assert program.moved(right) < SEEN, (edit, place, value)
            else:
                seen[-1] += 1
            table[place] = value
    assert program.passes()
    assert 0 < 2 * seen[0] < seen[1] < seen[2]
    assert seen[2] > 0.9 * sum(value != 0 for value in table)


@pytest.mark.slow
def test_every_number_of_a_march_that_can_matter_does(tmp_path):
    """A wave depends on most of them in no simple way: changes grow until one moves an output, or is as large as 1."""
    program = mutable("march", "double", "1e-9", tmp_path)
    right = program.outputs()
    seen = 0
    for name in WAVES:
        table = program.table(name)
        for place, value in enumerate(table):
            for sign in (1, -1):
                change, moved = 1e-15 * max(abs(value), 1), 0.0
                while change < 1 and moved < SEEN:
                    change *= 4
                    table[place] = value + sign * change
                    moved = program.moved(right)
                if moved >= SEEN:
                    assert not program.passes(), (name, place, value, table[place])
                    seen += 1
                table[place] = value
    assert seen > 300
    assert program.passes()


@pytest.mark.slow
def test_a_change_far_below_the_bound_is_none(tmp_path):
    """So it is the size of a change that is seen, not that there is one."""
    program = mutable("pieces", "double", "1e-9", tmp_path)
    right = program.outputs()
    table = program.table("coefficient")
    for place, value in enumerate(table):
        table[place] = value + 1e-6 / response(program, table, place, right)
    assert program.passes()


@pytest.mark.slow
def test_a_self_test_of_few_points_would_miss_some(monkeypatch, tmp_path):
    monkeypatch.setattr(program_form, "_MOST_POINTS", 12)
    program = mutable("pieces", "double", "1e-9", tmp_path)
    assert program.passes()
    assert len(unseen(program, "coefficient", program.outputs())) > 100


@pytest.mark.quick(1)
@pytest.mark.parametrize("evaluator", ["closed", "pieces"])
def test_the_last_printed_digits_of_a_coefficient_matter(evaluator, tmp_path):
    """In the text itself, as an editor would change it."""
    made = files(lower(scene("small", "1e-12", UNTIL)), "c", evaluator)
    bound = json.loads(made["small.json"])["error_bound"]
    _, numbers = next(found for found in re.findall(NUMBERS, made["small.c"], re.DOTALL) if found[0] == "coefficient")
    first = next(number.strip() for number in numbers.split(",") if len(number.strip()) > 16)
    changed = repr(float(first) * (1 + 100 * bound))
    assert changed[:8] == first[:8]
    assert changed != first
    assert statuses(made, first, changed, tmp_path) == [0, 1]


def watched():
    """The building with one output, and bounds of its largest value."""
    made = Scene(
        name="small",
        system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
        load=[{"times": [0, "5/2"], "a": [1, "-1/2"], "b": ["-1/4", 0]}],
        output={"until": UNTIL, "tolerance": "1e-9", "strain": ["1/3"]},
    )
    return made, Truth(made, Fraction(UNTIL)).largest(0, Fraction(UNTIL))


@pytest.mark.parametrize("evaluator", ["closed", "pieces", "march"])
def test_it_allows_one_bound_of_the_largest_value(evaluator):
    """And what its reference values are rounded by."""
    whole, (least, most) = watched()
    made = files(lower(whole), "c", evaluator)
    bound = json.loads(made["small.json"])["error_bound"]
    (allowed,) = re.findall(r"allowed\[\] = \{\s*(\S+?)\s*\}", made["small_selftest.c"])
    assert 0.9 * float(least) <= float(allowed) / (bound + 2.0**-52) <= float(most)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("evaluator", "right"), [("closed", "return sum;"), ("pieces", "sum = sum * w + *power;\n    }\n    return sum;")]
)
def test_values_that_are_wrong_by_two_bounds_are_seen(evaluator, right, tmp_path):
    """All of them, so that it is not the choice of instants that tells."""
    whole, (_, most) = watched()
    made = files(lower(whole), "c", evaluator)
    wrong = SEEN * json.loads(made["small.json"])["error_bound"] * float(most)
    assert made["small.c"].count(right) == 1
    assert statuses(made, right, right.replace("return sum", f"return sum + {wrong!r}"), tmp_path) == [0, 1]


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("evaluator", "right", "wrong"),
    [
        ("pieces", "sum.a = sum.a * w.a + power;", "sum.a = sum.a * w.a + power * (real)1.001;"),
        (
            "closed",
            "out[output * count + k] = at_tau[output];",
            "out[output * count + count - 1 - k] = at_tau[output];",
        ),
        ("march", "out[output * count + k] = at_tau[output];", "out[output * count + i] = at_tau[output];"),
        ("pieces", "s.rows[m][k] = not_a_number();", "s.rows[m][k] = 0;"),
        ("pieces", "outside = 1;", "outside = 0;"),
    ],
)
def test_sample_is_tested_too(evaluator, right, wrong, tmp_path):
    made = files(lower(scene("small", "1e-9", UNTIL)), "c", evaluator)
    assert statuses(made, right, wrong, tmp_path) == [0, 1]
