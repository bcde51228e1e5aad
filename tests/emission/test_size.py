"""The sizes that the manifest states for a small machine, against what a compiler for it makes."""

import json
import shutil
import subprocess

import pytest

import wavesym
from wavesym.emission.files import files

needs_clang = pytest.mark.skipif(not shutil.which("clang") or not shutil.which("llvm-size"), reason="no clang here")
SCENE = wavesym.Scene(
    name="small",
    system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
    load=[{"times": [0], "a": [1], "b": [0]}],
    output={"until": 6, "tolerance": "1e-4", "strain": ["1/2", "3/2"], "displacement": [2]},
)


@needs_clang
@pytest.mark.parametrize("evaluator", ["closed", "pieces"])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_code_and_data_are_no_larger_than_stated(evaluator, precision, tmp_path):
    made = files(SCENE, "c", evaluator, precision)
    for name, text in made.items():
        (tmp_path / name).write_text(text)
    # no C library for the target is needed to count bytes
    (tmp_path / "math.h").write_text('#define NAN (__builtin_nanf(""))\ndouble exp(double);\nfloat expf(float);\n')
    target = ["--target=thumbv7em-none-eabi", "-mcpu=cortex-m4", "-ffreestanding", "-std=c99", "-Os", "-I."]
    subprocess.run(["clang", *target, "-c", "small.c", "-o", "small.o"], cwd=tmp_path, check=True)
    listed = subprocess.run(["llvm-size", "-A", "small.o"], cwd=tmp_path, capture_output=True, text=True, check=True)
    sections = {
        words[0]: int(words[1])
        for words in map(str.split, listed.stdout.splitlines())
        if len(words) == 3 and words[1].isdigit()
    }
    stated = json.loads(made["small.json"])["size"]
    assert sum(size for name, size in sections.items() if name.startswith(".text")) <= stated["code_at_most"]
    tables = sum(size for name, size in sections.items() if name.startswith(".rodata"))
    # the outputs' names and their addresses are not tables, nor is what the linker joins
    assert stated["data"] <= tables + 4 <= stated["data"] + 256
    assert sections.get(".data", 0) == sections.get(".bss", 0) == 0
