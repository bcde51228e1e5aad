"""The plain C among the templates, read by a compiler as it stands; and put into programs with a scene's name."""

import platform
import re
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from tests.support.builds import LANGUAGES, SOURCES, STRICT, scene, source
from tests.support.generated import assemble
from wavesym.programs.choice import choose
from wavesym.programs.making import program
from wavesym.running.toolchain import CompilerError, compiler
from wavesym.scene import Scene, lower
from wavesym.targets.c.tables import declarations, tables_text

C = Path(__file__).parents[2] / "templates" / "c"
KERNELS = sorted(path.relative_to(C).as_posix() for path in C.rglob("*.c"))
HEADS = {kernel: (C / kernel).read_text().partition("\n\n")[0] for kernel in KERNELS}
INCLUDED = {
    (C / kernel).parent.joinpath(file).resolve()
    for kernel in KERNELS
    for file in re.findall(r'#include "(.*)"', HEADS[kernel])
}
READ = [kernel for kernel in KERNELS if C / kernel not in INCLUDED or "#if" in HEADS[kernel]]
"""Those with which no other begins, and those that begin otherwise where they stand alone: these read the rest, too."""
FORMATS = {"double": (), "single": ("-DSINGLE",)}
# what a kernel has for the text that stands below it in a program; clang tells of it, gcc does not
PARTS = ("-Wno-unused-function", "-Wno-unused-const-variable")


def complaint(file, folder, *flags, step="-c"):
    """What the compiler says of a file as it stands; empty where it takes it. With "-E" it is only preprocessed."""
    chosen = compiler()
    with TemporaryDirectory() as made:
        written = [step, file, "-o", str(Path(made) / "made.o")]  # zig knows no -fsyntax-only
        try:
            chosen.run([*LANGUAGES["c99"], *STRICT, *PARTS, *flags, *written], folder)
        except CompilerError as error:
            return str(error)
    return ""


@pytest.mark.quick(4)
@pytest.mark.parametrize("kernel", READ)
@pytest.mark.parametrize("precision", FORMATS)
def test_a_kernel_is_c_as_it_stands(kernel, precision):
    assert complaint(kernel, C, *FORMATS[precision]) == ""


@pytest.mark.parametrize(
    ("kernel", "name"), [("closed", "building_m2"), ("pieces", "building_m2"), ("march", "damped_building")]
)
def test_tables_are_what_their_header_declares(kernel, name):
    """No table more, none less, in its order, each of its type."""
    items = [item for paragraph in declarations(f"{kernel}/tables.h") for item in paragraph if item["table"]]
    types = {item["name"]: item["type"] for item in items}
    model = lower(Scene.from_toml(name))
    made = program(model, choose(model, kernel).evaluator).tables
    assert len(items) == len(types) > 0
    assert list(made) == list(types)
    for table, values in made.items():
        assert {isinstance(value, int) for value in values} <= {types[table] == "int"}, table


HEAD = re.compile(r"^static (?:inline )?(\w[\w ]*? \*?)(?:OF\()?\w+\)?\(([^{;]*)\)\n\{", re.MULTILINE)
VECTORS = re.compile(r"(const )?(num|wide|mask)( \w+)?")


def test_no_set_of_numbers_is_passed_by_value():
    """clang warns of each that is wider than those of the machine: callers might pass it otherwise."""
    heads = [head for kernel in KERNELS for head in HEAD.findall((C / kernel).read_text())]
    assert len(heads) > 100
    said = [word.strip() for kind, words in heads for word in (kind, *" ".join(words.split()).split(","))]
    assert [word for word in said if VECTORS.fullmatch(word)] == []


@pytest.mark.parametrize(
    ("kernel", "right", "wrong"),
    [
        ("closed/closed.c", "+ excess[pulse];", "+ excess[pulse]"),
        ("closed/closed.c", "sum += polynomial", "sum += polynom"),
        ("pieces/pieces.c", "(size_t)member[", "member["),
        ("march/march.c", "const real middle = ", "const float middle = "),
        ("march/march.c", "int outside = 0;", "int outside = 0, before = 0;"),
    ],
)
def test_a_broken_kernel_is_seen(kernel, right, wrong, tmp_path):
    shutil.copytree(C, tmp_path, dirs_exist_ok=True)
    text = (tmp_path / kernel).read_text()
    assert right in text
    (tmp_path / kernel).write_text(text.replace(right, wrong))
    assert complaint(kernel, tmp_path)


@pytest.mark.quick(1)
@pytest.mark.parametrize("of", SOURCES, ids="-".join)
def test_a_program_writes_all_tables_that_it_has(of):
    made = source(*of)
    written = set(re.findall(r"^static const (?:int|real) (\w+)\[\]", made.made[f"{made.name}.c"], re.MULTILINE))
    of_program = assemble(choose(lower(scene(made.name, "1e-2")), *of).evaluator).tables
    assert written == of_program.keys() - {"point"}  # which the header declares


def test_tables_are_written_as_they_are_declared():
    """In order, with the comments above those that there are."""
    values = {"steps": ("1, 2,", "3"), "ring": ("0",), "track": ("7",)}
    enumeration, first, second = tables_text("march/tables.h", values, {"degree": "7", "span": "2.0"})
    assert "    DEGREE = 7,\n    SIZE = DEGREE + 1,\n    PANELS = 2,\n" in enumeration
    assert first.startswith("/* tracks: how many windows later what is sent arrives */")
    assert "static const int steps[] = {\n    1, 2,\n    3\n};\n\n/* where the ring of" in first
    assert first.endswith("and delays. */\nstatic const int track[] = {\n    7\n};\n")
    assert first.count("/*") == 3
    assert second.endswith("where they begin in it. */\nstatic const real span = 2.0;")


@pytest.mark.quick(1)
@pytest.mark.parametrize("of", SOURCES, ids="-".join)
def test_a_program_is_its_kernel_under_its_own_name(of):
    made = source(*of)
    text = made.made[f"{made.name}.c"]
    assert not re.search(r"\b(name|NAME)_|tables\.h", text)
    kernel = (C / of[0] / f"{of[0]}.c").read_text().partition("\n\n")[2]
    assert text.endswith(re.sub(r"\bname_", f"{made.name}_", re.sub(r"\bNAME_", f"{made.name.upper()}_", kernel)))


@pytest.mark.quick(10)
@pytest.mark.parametrize("kernel", KERNELS)
def test_fast_math_is_refused_unless_it_is_asked_for(kernel):
    assert "no longer hold" in complaint(kernel, C, "-ffast-math", step="-E")
    assert complaint(kernel, C, "-ffast-math", "-DNAME_ALLOW_FAST_MATH", step="-E") == ""


def test_no_function_has_a_name_that_a_compiler_knows():
    """From version 18 on clang warns of calls of these under -ffast-math, whoever declared them."""
    for file in C.rglob("*.c"):
        assert not re.search(r"\b(infinity|isinf|isnan|isfinite|isunordered)\(", file.read_text()), file.name


@pytest.mark.skipif(platform.machine() != "x86_64" or not shutil.which("gcc"), reason="no gcc for x86-64 here")
@pytest.mark.parametrize("flag", ["-funsafe-math-optimizations", "-freciprocal-math", "-mfpmath=387"])
def test_arithmetic_that_is_not_that_of_the_bounds_is_refused(flag, monkeypatch):
    """Sums in another order were wrong by 2.8 bounds; the x87 refused TAU_MAX, and took wrong sides of jumps."""
    monkeypatch.setenv("CC", "gcc")
    for kernel in ("closed/closed.c", "pieces/pieces.c"):
        assert "bounds of errors no longer hold" in complaint(kernel, C, flag)
    assert complaint("closed/closed.c", C, flag, "-DNAME_ALLOW_FAST_MATH") == ""
