"""The bytes that a header states: of structs and of stacks, against what a compiler makes of them."""

import ctypes
import re
import subprocess

import pytest

import wavesym
from tests.support.builds import LANGUAGES, STRICT
from tests.support.built_model import written
from tests.support.stack import deepest, needs_graphs
from tests.targets.test_runtime_c import BUILDING
from wavesym.programs.request import PARTS
from wavesym.running.toolchain import compiler
from wavesym.targets.c import memory

CHAIN = wavesym.Scene.from_toml("stepped_shaft")
RECORD = wavesym.Scene(
    name="shaken",
    system={"type": "building", "m": 8, "kappa": ["1/4"] * 9, "base": "ground"},
    load=[{"spacing": "1/16", "samples": [0, 1, -1, "1/2", "1/3", 0]}],
    output={"until": 3, "tolerance": "1e-6", "drift": [1, 8]},
)
"""With 16 panels: too much for a stack."""
CASES = {
    "building": (BUILDING, ["kappa", "load"], "double", 10),
    "chain": (CHAIN, ["mass", "impedance"], "single", 10),
    "building in single precision": (BUILDING, ["kappa"], "single", 1),
    "chain in double precision": (CHAIN, ["mass", "load"], "double", 100),
    "many panels": (RECORD, ["kappa"], "double", 10),
}
STRUCTS = ("model", "work", "tangent", "batch", "data")
WHO = {
    "build": ["build"],
    "build_with": ["build_with"],
    "error_estimate, model_eval, model_sample": ["error_estimate", "model_eval", "model_sample"],
    "model_peaks": ["model_peaks"],
    "functions of a tangent": ["build_tangent", "tangent_estimate", "tangent_sample"],
    "functions of a batch and of data": ["build_batch", "batch_model", "data_size", "data_init", "batch_misfit"],
    "error_bound": ["error_bound"],
    "error_bound_with": ["error_bound_with"],
}
WITH_OTHERS = list(WHO)[4:]


def made(case, folder, parts=PARTS):
    scene, runtime, precision, kappa_max = CASES[case]
    written(scene, runtime, folder, precision=precision, parts=parts, kappa_max=kappa_max)
    return scene.name


def stated(folder, name):
    """Of structs and of stacks, as the first comment of a header has them."""
    comment = (folder / f"{name}.h").read_text().partition("*/")[0]
    return [
        {what: int(size) for size, what in re.findall(r"^ \* +(\d+)  ([^\n]*)$", part, re.MULTILINE)}
        for part in comment.split("Stack,")
    ]


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", CASES)
def test_a_header_states_the_sizes_of_its_structs(case, tmp_path):
    name = made(case, tmp_path)
    sizes = ", ".join(f"sizeof({name}_{struct})" for struct in STRUCTS)
    (tmp_path / "size.c").write_text(
        f'#include "{name}.h"\nextern const size_t size[5];\nconst size_t size[5] = {{{sizes}}};\n'
    )
    compiler().run([*LANGUAGES["c99"], *STRICT, "-fPIC", "-shared", "size.c", "-o", "size.so"], tmp_path)
    found = list((ctypes.c_size_t * 5).in_dll(ctypes.CDLL(str(tmp_path / "size.so")), "size"))
    memory, _ = stated(tmp_path, name)
    assert [what.partition(",")[0] for what in memory] == [f"{name}_{struct}" for struct in STRUCTS]
    assert list(memory.values()) == found


def vector(flags):
    """Bytes of the widest vectors that gcc uses with these flags."""
    known = subprocess.run(
        ["gcc", *flags, "-dM", "-E", "-"], input="", capture_output=True, text=True, check=True
    ).stdout
    return 64 if "__AVX512F__" in known else 32 if "__AVX__" in known else 16


@pytest.mark.slow
@needs_graphs
@pytest.mark.parametrize(
    "how",
    [
        ("building", ("peaks",), ("-O2",)),
        ("building", PARTS, ("-Os",)),
        ("building", PARTS, ("-O3", "-march=native", "-ffp-contract=fast")),
        ("building in single precision", PARTS, ("-O1",)),
        ("chain", PARTS, ("-O2",)),
        ("chain in double precision", PARTS, ("-O3",)),
        ("many panels", PARTS, ("-O2",)),
    ],
)
def test_no_function_needs_more_stack_than_its_header_states(how, tmp_path, monkeypatch):
    """Headers count vectors of 64 bytes; with those that the compiler has here what they state is not far from it."""
    case, parts, flags = how
    name = made(case, tmp_path, parts)
    found = deepest(tmp_path, name, *flags)
    _, stack = stated(tmp_path, name)
    monkeypatch.setattr(memory, "_VECTOR", vector(flags))
    made(case, tmp_path, parts)
    _, here = stated(tmp_path, name)
    usual = deepest(tmp_path, name, "-O2") if "-Os" in flags else found  # one header is for both
    assert stack.keys() == (WHO.keys() if parts == PARTS else WHO.keys() - WITH_OTHERS)
    assert {function for what in stack for function in WHO[what]} == found.keys()
    for what, size in stack.items():
        most = max(found[function] for function in WHO[what])
        assert most <= here[what] <= size, what
        assert here[what] <= 5 * max(most, *(usual[function] for function in WHO[what])) + 1024, what


BY_ITSELF = """
#include "NAME.h"
#include <string.h>
int both(void);
int both(void)
{
    static NAME_work work;
    static NAME_model one, other;
    NAME_parameters set = NAME_defaults;
    double *const numbers = (double *)&set;
    double factor = 1.0 / 16;
    int wrong = 0;
    for (int k = 0; k < 30; ++k, factor *= 1.2) {
        set = NAME_defaults;
        for (size_t j = 0; j < sizeof set / sizeof(double); ++j) {
            numbers[j] *= factor;
        }
        memset(&work, 0xff, sizeof work);
        memset(&one, 0xff, sizeof one);
        memset(&other, 0xff, sizeof other);
        const int status = NAME_build(&one, &set);
        wrong += NAME_build_with(&work, &other, &set) != status || status == 1;
        wrong += memcmp(one.series, other.series, sizeof one.series) != 0;
        wrong += status == 0 && NAME_error_estimate(&one) != NAME_error_estimate(&other);
    }
    return wrong;
}
"""
WIDEST = "-D__AVX512F__"
"""Makes every compiler take vectors of 64 bytes, in pieces where the machine has narrower ones."""


@pytest.mark.slow
@pytest.mark.parametrize("width", [(), (WIDEST, "-Wno-psabi")], ids=["vectors", "widest"])
@pytest.mark.parametrize("case", ["building", *["many panels", "chain in double precision"]])
def test_a_model_is_the_same_wherever_it_is_built(case, width, tmp_path):
    """In the model itself, where that is more than a stack has; in memory that holds no numbers, at every degree."""
    scene, runtime, _, kappa_max = CASES[case]
    written(scene, runtime, tmp_path, parts=[], kappa_max=kappa_max)
    name = scene.name
    memory, stack = stated(tmp_path, name)
    model, work = memory.values()
    inside = any("kept in a model" in what for what in memory)
    assert inside == (case == "many panels") == (work > 65536)
    assert stack["build"] - stack["build_with"] == (0 if inside else work)
    assert (model > work) or not inside
    (tmp_path / "both.c").write_text(BY_ITSELF.replace("NAME", name))
    compiler().run(
        [*LANGUAGES["c99"], *STRICT, *width, "-O1", "-fPIC", "-shared", f"{name}.c", "both.c", "-o", "both.so"],
        tmp_path,
    )
    assert ctypes.CDLL(str(tmp_path / "both.so")).both() == 0
