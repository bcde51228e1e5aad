"""Vectors of generated C stay in registers: the assembly for aarch64, as a cross compiler writes it.

gcc 12 is known; what other versions keep in registers is not. A spill is what gcc itself calls one: with -fverbose-asm
the operand of a load or store of a register that it ran out of is `%sfp`, that of a variable has the variable's name.
So arrays of series and tables, which loops go over and functions fill for each other, are none.
"""

import re
import shutil
import subprocess
from dataclasses import replace

import pytest

from tests.support.built_model import written
from tests.targets.test_runtime_c import BUILDING
from tools.portable.subjects import COMPILED
from wavesym.programs.request import Request

ARM = "aarch64-linux-gnu-gcc"
KNOWN = "12"
STORED = re.compile(r"st(?:r|p|ur)\s+(q\d+)(?:, q\d+)?, \[(?:sp|x29)(?:, (-?\d+))?\]")
LOADED = re.compile(r"ld(?:r|p|ur)\s+(q\d+)(?:, q\d+)?, \[(?:sp|x29)(?:, (-?\d+))?\]")
SPILLED = re.compile(r"^\t(?:st|ld)(?:r|p|ur)\s+q\d+.*%sfp", re.M)
FUNCTION = re.compile(r"^(\w+)[.\w]*:\n(.*?)^\t\.size\t\1[.\w]*,", re.M | re.S)
# where gcc takes up to two numbers at once by itself: sums and addresses around a call that sets memory to 0
LEFT = {
    ("stream_double", "-O2"): {"stream_double_step"},
    ("blocks_double", "-O3"): {"advance"},
    ("blocks_single", "-O3"): {"advance"},
    ("mode_sets_double", "-O2"): {"read_output"},
    ("mode_sets_double", "-O3"): {"read_output"},
}


def version():
    """The first number of the cross compiler's version; "" without one."""
    if not shutil.which(ARM):
        return ""
    said = subprocess.run([ARM, "-dumpversion"], capture_output=True, text=True, check=True).stdout
    return said.strip().partition(".")[0]


def assembly(name, level, folder):
    command = [ARM, "-std=c99", level, "-fverbose-asm", "-S", f"{name}.c", "-o-"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout


def spilling(text):
    """The functions that write a vector to the stack, or read it from there, for want of registers."""
    bodies = FUNCTION.findall(text)
    assert bodies
    return {name for name, body in bodies if SPILLED.search(body)}


def mode_sets():
    """Numbers of modes at run time, of a building as portable programs of modes have it."""
    modes = next(program for program in COMPILED if program.template == "modes")
    request = Request("modes", runtime=("stiffness", "damping", "load"), parts=("peaks",))
    return replace(modes, template="mode_sets", request=request)


PROGRAMS = (*COMPILED, mode_sets())
needs_gcc = pytest.mark.skipif(version() != KNOWN, reason=f"no {ARM} {KNOWN} here")


@pytest.mark.slow
@needs_gcc
@pytest.mark.parametrize("program", PROGRAMS, ids=[program.name for program in PROGRAMS])
def test_no_vector_is_spilled(program, tmp_path):
    for file, text in program.files().items():
        (tmp_path / file).write_text(text)
    for level in ("-O2", "-O3"):
        assert spilling(assembly(program.name, level, tmp_path)) == LEFT.get((program.name, level), set()), level


@pytest.mark.slow
@needs_gcc
def test_a_spill_would_be_seen(tmp_path):
    changes = [('__asm__ volatile("" : "+r"(number))', "")]  # what is loaded may be kept at hand, too much of it
    written(BUILDING, ["kappa"], tmp_path, changes, parts=["bound"])
    assert f"{BUILDING.name}_error_bound_with" in spilling(assembly(BUILDING.name, "-O2", tmp_path))


def slots(pattern, text):
    """Where on the stack vectors are: from what offset on."""
    return {int(line[2] or 0) + 16 * k for line in pattern.finditer(text) for k in range(line[0].count("q"))}


def through_memory(text):
    """What reads samples or steps bodies puts so many vectors on the stack that none is read from: lanes are taken out
    there, or loops go over arrays."""
    names = r"(?:run|sample_series|\w+_sample|step_bodies\w*)[.\w]*"
    bodies = re.findall(rf"^({names}):\n(.*?)^\t\.size\t\1,", text, re.M | re.S)
    assert bodies
    return sum(len(slots(STORED, body) - slots(LOADED, body)) for _, body in bodies)


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which(ARM), reason=f"no {ARM} here")
def test_models_are_stepped_and_read_without_vectors_on_the_stack(tmp_path):
    def found(*changes):
        written(BUILDING, ["kappa"], tmp_path, changes, parts=["batch"])
        return through_memory(assembly(BUILDING.name, "-O2", tmp_path))

    assert found() == 0
    # as it was: the last samples of a row by way of an array
    loop = "for (size_t lane = 0; lane < LANES; ++lane) {"
    array = (
        "real rest[LANES]; *(slice *)rest = sum[i * width + j]; for (size_t lane = 0; to + lane < s->count; ++lane) {"
    )
    assert found((f"UNROLLED\n            {loop}", array), ("AT(sum[i * width + j], lane)", "rest[lane]")) > 0
