"""The sizes that the manifest states for a small machine, against what a compiler for it makes."""

import json

import pytest

import wavesym
from tests.support.builds import needs_binutils, sections
from tests.support.generated import files
from wavesym.running.toolchain import at_hand, compiler
from wavesym.scene import lower

TARGETS = {
    "clang": ("--target=thumbv7em-none-eabi", "-mcpu=cortex-m4"),
    "ziglang": ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m4"),
}
LEAST = 0.9
"""The part of the stated tables that must be there: what is stated is a bound, as clang 19 and ziglang leave out what
is 0 or the same twice."""
SCENE = wavesym.Scene(
    name="small",
    system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
    load=[{"times": [0], "a": [1], "b": [0]}],
    output={"until": 6, "tolerance": "1e-4", "strain": ["1/2", "3/2"], "displacement": [2]},
)


@pytest.mark.quick(3)
@needs_binutils
@pytest.mark.parametrize("made_by", [each for each in at_hand() if each.name in TARGETS], ids=lambda each: each.name)
@pytest.mark.parametrize("evaluator", ["closed", "pieces"])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_code_and_data_are_no_larger_than_stated(evaluator, precision, made_by, tmp_path):
    made = files(lower(SCENE), "c", evaluator, precision)
    for name, text in made.items():
        (tmp_path / name).write_text(text)
    # no C library for the target is needed to count bytes
    (tmp_path / "math.h").write_text('#define NAN (__builtin_nanf(""))\ndouble exp(double);\nfloat expf(float);\n')
    flags = [*TARGETS[made_by.name], "-ffreestanding", "-std=c99", "-Os", "-I."]
    made_by.run([*flags, "-c", "small.c", "-o", "small.o"], tmp_path)
    sizes = sections(tmp_path / "small.o")
    stated = json.loads(made["small.json"])["size"]
    assert sum(size for name, size in sizes.items() if name.startswith(".text")) <= stated["code_at_most"]
    tables = sum(size for name, size in sizes.items() if name.startswith(".rodata"))
    # the outputs' names and their addresses are not tables
    assert LEAST * stated["data"] <= tables <= stated["data"] + 256
    assert not sizes.keys() & {".data", ".bss"}


@needs_binutils
@pytest.mark.slow
@pytest.mark.parametrize("evaluator", ["closed", "pieces", "march"])
def test_double_precision_takes_at_most_twice_the_bytes(evaluator, tmp_path):
    """Of the smallest programs at equal tolerance (text and tables), as the compiler of this machine makes them."""
    # a march in single precision cannot do better
    asked = SCENE.with_({"output.tolerance": "1e-2"}) if evaluator == "march" else SCENE
    sizes = {}
    for precision in ("double", "single"):
        made = files(lower(asked), "c", evaluator, precision, None, "size")
        folder = tmp_path / precision
        folder.mkdir()
        for name, text in made.items():
            (folder / name).write_text(text)
        compiler().run(["-std=c99", "-Os", "-c", "small.c", "-o", "small.o"], folder)
        found = sections(folder / "small.o")
        sizes[precision] = sum(size for name, size in found.items() if name.startswith((".text", ".rodata")))
    assert 0 < sizes["double"] <= 2 * sizes["single"]
