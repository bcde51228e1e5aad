"""Vectors of generated C stay in registers: the assembly for another machine, as a cross compiler writes it."""

import re
import shutil
import subprocess

import pytest

from tests.support.built_model import written
from tests.targets.test_runtime_c import BUILDING

ARM = "aarch64-linux-gnu-gcc"
STORED = re.compile(r"st(?:r|p|ur)\s+(q\d+)(?:, q\d+)?, \[(?:sp|x29)(?:, (-?\d+))?\]")
LOADED = re.compile(r"ld(?:r|p|ur)\s+(q\d+)(?:, q\d+)?, \[(?:sp|x29)(?:, (-?\d+))?\]")


def slots(pattern, text):
    """Where on the stack vectors are: from what offset on."""
    return {int(line[2] or 0) + 16 * k for line in pattern.finditer(text) for k in range(line[0].count("q"))}


def through_memory(assembly):
    """What reads samples or steps bodies puts so many vectors on the stack that none is read from: lanes are taken out
    there, or loops go over arrays."""
    names = r"(?:run|sample_series|\w+_sample|step_bodies\w*)[.\w]*"
    bodies = re.findall(rf"^({names}):\n(.*?)^\t\.size\t\1,", assembly, re.M | re.S)
    assert bodies
    return sum(len(slots(STORED, body) - slots(LOADED, body)) for _, body in bodies)


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which(ARM), reason=f"no {ARM} here")
def test_models_are_stepped_and_read_without_vectors_on_the_stack(tmp_path):
    def found(*changes):
        written(BUILDING, ["kappa"], tmp_path, changes, parts=["batch"])
        command = [ARM, "-std=c99", "-O2", "-S", f"{BUILDING.name}.c", "-o-"]
        return through_memory(subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout)

    assert found() == 0
    # as it was: the last samples of a row by way of an array
    loop = "for (size_t lane = 0; lane < LANES; ++lane) {"
    array = (
        "real rest[LANES]; *(slice *)rest = sum[i * width + j]; for (size_t lane = 0; to + lane < s->count; ++lane) {"
    )
    assert found((f"UNROLLED\n            {loop}", array), ("AT(sum[i * width + j], lane)", "rest[lane]")) > 0
