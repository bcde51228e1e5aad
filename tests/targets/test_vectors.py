"""Vectors of generated C stay in registers: the assembly for aarch64, as two compilers write it for that machine.

gcc 12 and clang 14 are known; what other versions keep in registers is not. A spill is what a compiler itself calls
one. With -fverbose-asm gcc writes `%sfp` for the operand of a load or store of a register that it ran out of, and for a
variable its name; clang writes `Folded Spill` or `Folded Reload` behind it. So arrays of series and tables, which loops
go over and functions fill for each other, are none.
"""

import re
import shutil
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from tests.support.built_model import written
from tests.targets.test_runtime_c import BUILDING
from tools.portable.subjects import COMPILED
from wavesym.programs.request import Request

HEADERS = "/usr/aarch64-linux-gnu/include"
STORED = re.compile(r"st(?:r|p|ur)\s+(q\d+)(?:, q\d+)?, \[(?:sp|x29)(?:, (-?\d+))?\]")
LOADED = re.compile(r"ld(?:r|p|ur)\s+(q\d+)(?:, q\d+)?, \[(?:sp|x29)(?:, (-?\d+))?\]")
FUNCTION = re.compile(r"^(\w+)[.\w]*:[^\n]*\n(.*?)^\t\.size\t\1[.\w]*,", re.M | re.S)


@dataclass(frozen=True)
class CrossCompiler:
    """How one is called, the first number of its version, and of what lines it says that they spill a vector."""

    name: str
    command: tuple[str, ...]
    known: str
    spilled: re.Pattern[str]

    def is_here(self):
        if not shutil.which(self.command[0]) or not Path(HEADERS).exists():
            return False
        said = subprocess.run([self.command[0], "-dumpversion"], capture_output=True, text=True, check=True).stdout
        return said.strip().partition(".")[0] == self.known

    def assembly(self, name, level, folder):
        command = [*self.command, "-std=c99", level, "-S", f"{name}.c", "-o-"]
        return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout

    def spilling(self, text):
        """The functions that write a vector to the stack, or read it from there, for want of registers."""
        bodies = FUNCTION.findall(text)
        assert bodies
        return {name for name, body in bodies if self.spilled.search(body)}


GCC = CrossCompiler(
    "gcc",
    ("aarch64-linux-gnu-gcc", "-fverbose-asm"),
    "12",
    re.compile(r"^\t(?:st|ld)(?:r|p|ur)\s+q\d+.*%sfp", re.M),
)
CLANG = CrossCompiler(
    "clang",
    ("clang", "--target=aarch64-linux-gnu", "-isystem", HEADERS),
    "14",
    re.compile(r"^\t(?:st|ld)(?:r|p|ur)\s+q\d+.*-byte Folded (?:Spill|Reload)", re.M),
)
COMPILERS = [
    pytest.param(each, id=each.name, marks=pytest.mark.skipif(not each.is_here(), reason=f"no {each.name} known"))
    for each in (GCC, CLANG)
]


def mode_sets():
    """Numbers of modes at run time, of a building as portable programs of modes have it."""
    modes = next(program for program in COMPILED if program.template == "modes")
    request = Request("modes", runtime=("stiffness", "damping", "load"), parts=("peaks",))
    return replace(modes, template="mode_sets", request=request)


PROGRAMS = (*COMPILED, mode_sets())


@pytest.mark.slow
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("program", PROGRAMS, ids=[program.name for program in PROGRAMS])
def test_no_vector_is_spilled(program, compiler, tmp_path):
    for file, text in program.files().items():
        (tmp_path / file).write_text(text)
    for level in ("-O2", "-O3"):
        assert compiler.spilling(compiler.assembly(program.name, level, tmp_path)) == set(), level


# what is loaded may be kept at hand, too much of it; constants of functions that are put into loops wait there
KEPT = ('__asm__ volatile("" : "+r"(number))', "")
PUT_IN = ("#define BY_ITSELF __attribute__((noinline))", "#define BY_ITSELF")


@pytest.mark.slow
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("change", [KEPT, PUT_IN], ids=["kept", "put in"])
def test_a_spill_would_be_seen(change, compiler, tmp_path):
    def found(*changes):
        written(BUILDING, ["kappa"], tmp_path, changes, parts=["bound", "batch"])
        return compiler.spilling(compiler.assembly(BUILDING.name, "-O2", tmp_path))

    assert not found()
    assert found(change)


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
@pytest.mark.skipif(not shutil.which(GCC.command[0]), reason="no gcc for aarch64 here")
def test_models_are_stepped_and_read_without_vectors_on_the_stack(tmp_path):
    def found(*changes):
        written(BUILDING, ["kappa"], tmp_path, changes, parts=["batch"])
        return through_memory(GCC.assembly(BUILDING.name, "-O2", tmp_path))

    assert found() == 0
    # as it was: the last samples of a row by way of an array
    loop = "for (size_t lane = 0; lane < LANES; ++lane) {"
    array = (
        "real rest[LANES]; *(slice *)rest = sum[i * width + j]; for (size_t lane = 0; to + lane < s->count; ++lane) {"
    )
    assert found((f"UNROLLED\n            {loop}", array), ("AT(sum[i * width + j], lane)", "rest[lane]")) > 0
