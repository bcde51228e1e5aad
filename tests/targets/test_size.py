"""The sizes that the manifest states for a small machine, against what a compiler for it makes."""

import json

import pytest

import wavesym
from tests.support.builds import needs_binutils, sections
from tests.support.generated import files
from wavesym.running.toolchain import at_hand
from wavesym.scene import lower

TARGETS = {
    "clang": ("--target=thumbv7em-none-eabi", "-mcpu=cortex-m4"),
    "ziglang": ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m4"),
}
# the part of the stated tables that must be there: this compiler leaves out what is 0 or the same twice
LEAST = {"ziglang": 0.9}
SCENE = wavesym.Scene(
    name="small",
    system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
    load=[{"times": [0], "a": [1], "b": [0]}],
    output={"until": 6, "tolerance": "1e-4", "strain": ["1/2", "3/2"], "displacement": [2]},
)


@needs_binutils
@pytest.mark.parametrize("compiler", [each for each in at_hand() if each.name in TARGETS], ids=lambda each: each.name)
@pytest.mark.parametrize("evaluator", ["closed", "pieces"])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_code_and_data_are_no_larger_than_stated(evaluator, precision, compiler, tmp_path):
    made = files(lower(SCENE), "c", evaluator, precision)
    for name, text in made.items():
        (tmp_path / name).write_text(text)
    # no C library for the target is needed to count bytes
    (tmp_path / "math.h").write_text('#define NAN (__builtin_nanf(""))\ndouble exp(double);\nfloat expf(float);\n')
    flags = [*TARGETS[compiler.name], "-ffreestanding", "-std=c99", "-Os", "-I."]
    compiler.run([*flags, "-c", "small.c", "-o", "small.o"], tmp_path)
    sizes = sections(tmp_path / "small.o")
    stated = json.loads(made["small.json"])["size"]
    assert sum(size for name, size in sizes.items() if name.startswith(".text")) <= stated["code_at_most"]
    tables = sum(size for name, size in sizes.items() if name.startswith(".rodata"))
    # the outputs' names and their addresses are not tables
    assert LEAST.get(compiler.name, 1) * stated["data"] <= tables <= stated["data"] + 256
    assert not sizes.keys() & {".data", ".bss"}
