"""The generated C under every compiler at hand: standards, optimisation, contraction, sanitizers, symbols, sections."""

from __future__ import annotations

import subprocess
from collections import Counter
from itertools import cycle, islice, product

import pytest

from tests.support.builds import LANGUAGES, SOURCES, STRICT, built, needs_binutils, sections, source
from wavesym.running.compilation import FLAGS
from wavesym.running.toolchain import CompilerError, at_hand, compiler

KNOWN = ("gcc", "clang", "ziglang")
OPTIMISED = {"-O0": ("-O0",), "-O2": ("-O2",), "-O3": ("-O3", "-march=native")}
CONTRACTED = {"contracted": ("-ffp-contract=fast",), "rounded": ("-ffp-contract=off",)}
WAYS = list(product(OPTIMISED, CONTRACTED))
SANITIZERS = {"address": ("-fsanitize=address",), "undefined": ("-fsanitize=undefined", "-fno-sanitize-recover=all")}
# objects for a fixed address: elsewhere the addresses of the outputs' names are filled in when they are loaded
FIXED = {"gcc": ("-fno-pic", "-fno-pie"), "clang": ("-fno-pic", "-fno-pie")}
# what the C library has for it, and what compilers put in place of loops
IMPORTED = {"exp", "expf", "fabs", "fabsf", "memcpy", "memmove", "memset"}

each_source = pytest.mark.parametrize("of", SOURCES, ids="-".join)
each_compiler = pytest.mark.parametrize("name", KNOWN)


@pytest.fixture(scope="module")
def tally(request):
    """What was built and what was not, told at the end of the run."""
    counted = Counter()
    yield counted
    with request.config.pluginmanager.getplugin("capturemanager").global_and_fixture_disabled():
        print("", *(f"generated C, {what}: {count}" for what, count in sorted(counted.items())), sep="\n")


def named(name, tally):
    """A compiler by its name; skipped where it is not at hand."""
    for found in at_hand():
        if found.name == name:
            return found
    tally[f"skipped, no {name}"] += 1
    return pytest.skip(f"no {name} here")


@pytest.mark.quick(3)
@each_source
def test_the_default_compiler_takes_it_and_it_is_right(of, tmp_path, tally):
    assert built(source(*of), compiler(), FLAGS, tmp_path) <= 1
    tally["built with the default compiler"] += 1


def test_a_wrong_value_would_be_seen(tmp_path):
    right = source("closed", "double")
    text = right.made["closed_double.c"]
    wrong = text.replace("return sum;", "return sum * (1 + 3e-9);")
    assert wrong != text
    spoilt = type(right)(**{**vars(right), "made": {**right.made, "closed_double.c": wrong}})
    with pytest.raises(AssertionError):
        assert built(spoilt, compiler(), FLAGS, tmp_path) <= 1


@pytest.mark.slow
@each_compiler
@pytest.mark.parametrize("way", range(len(WAYS)), ids=map("-".join, WAYS))
def test_every_way_to_build_it(name, way, tmp_path, tally):
    """Each source in one language of three: a way meets every language twice, and so does a source."""
    found = named(name, tally)
    optimised, contracted = WAYS[way]
    flags = (*OPTIMISED[optimised], *CONTRACTED[contracted], *STRICT)
    for of, language in zip(SOURCES, islice(cycle(LANGUAGES), way, None), strict=False):
        assert built(source(*of), found, (*LANGUAGES[language], *flags), tmp_path) <= 1
        tally[f"built with {name} as {language}"] += 1


@pytest.mark.slow
@each_compiler
@pytest.mark.parametrize("sanitizer", SANITIZERS)
def test_sanitizers_find_nothing(name, sanitizer, tmp_path, tally):
    found = named(name, tally)
    flags = ["-std=c99", "-g", "-O1", *SANITIZERS[sanitizer]]
    (tmp_path / "empty.c").write_text("int main(void) { return 0; }\n")
    try:
        found.run([*flags, "empty.c", "-o", "empty"], tmp_path)
    except CompilerError as error:
        tally[f"skipped, {name} has no {sanitizer} sanitizer"] += 1
        pytest.skip(f"{name} has no {sanitizer} sanitizer: {error}")
    for of in SOURCES:
        made = source(*of)
        made.write(tmp_path)
        files = [f"{made.name}.c", f"{made.name}_selftest.c"]
        found.run([*flags, *files, "-o", "selftest", "-lm"], tmp_path)
        told = subprocess.run([tmp_path / "selftest"], capture_output=True, text=True, check=False)
        assert (told.returncode, told.stderr) == (0, "")
        tally[f"run under the {sanitizer} sanitizer of {name}"] += 1


@pytest.mark.slow
@each_compiler
@pytest.mark.parametrize(("sanitizer", "flaw"), [("address", "table[k]"), ("undefined", "k + 2147483600")])
def test_sanitizers_find_what_is_wrong(name, sanitizer, flaw, tmp_path, tally):
    found = named(name, tally)
    (tmp_path / "flawed.c").write_text(
        f"int main(int k, char **names)\n{{\n    volatile int table[100] = {{0}};\n    (void)names;\n"
        f"    k = 100 * k;\n    table[0] = {flaw};\n    return 0;\n}}\n"
    )
    try:
        found.run(["-std=c99", "-g", "-O1", *SANITIZERS[sanitizer], "flawed.c", "-o", "flawed"], tmp_path)
    except CompilerError as error:
        pytest.skip(f"{name} has no {sanitizer} sanitizer: {error}")
    assert subprocess.run([tmp_path / "flawed"], capture_output=True, check=False).returncode != 0


PROGRAM = """
#include <stdio.h>
{headers}
int main(void)
{{
    int outside = 0;
{calls}
    return outside;
}}
"""


@pytest.mark.quick(1)
@pytest.mark.parametrize("language", ["c++17", "c99"])
def test_several_scenes_are_one_program(language, tmp_path):
    """No two of them share a name, and headers do not mind each other."""
    made = [source(*of) for of in SOURCES]
    for each in made:
        each.write(tmp_path)
    calls = (
        f"    {{ {'double' if each.name.endswith('double') else 'float'} out[{each.name.upper()}_OUTPUTS];"
        f' outside |= {each.name}_eval(1, out); printf("%.17g\\n", (double)out[2]); }}'
        for each in made
    )
    headers = "\n".join(f'#include "{each.name}.h"' for each in made)
    (tmp_path / "main.c").write_text(PROGRAM.format(headers=headers, calls="\n".join(calls)))
    flags = [*LANGUAGES[language], "-O2", *STRICT]
    compiler().run([*flags, "main.c", *(f"{each.name}.c" for each in made), "-o", "main", "-lm"], tmp_path)
    told = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout
    values = [float(line) for line in told.splitlines()]
    assert len(values) == len(SOURCES)
    for value, each in zip(values, made, strict=True):
        (place,) = (each.taus == 1).nonzero()[0]
        assert abs(value - each.true[2, place]) <= each.allowed[2]


def symbols(path):
    """The global symbols of an object file: those it defines, and those it asks for."""
    listed = subprocess.run(["nm", "-g", path], capture_output=True, text=True, check=True).stdout
    lines = [line.split() for line in listed.splitlines()]
    return {words[-1] for words in lines if words[-2] != "U"}, {words[-1] for words in lines if words[-2] == "U"}


def written(sizes):
    """Of the sections of a program those that it may write to."""
    kept = (".data.rel.ro",)  # read-only once the program is loaded; none of it at a fixed address
    return {section for section in sizes if section.startswith((".data", ".bss")) and not section.startswith(kept)}


def object_file(text, name, folder, found):
    (folder / f"{name}.c").write_text(text)
    found.run(["-std=c99", "-O2", *FIXED.get(found.name, ()), "-c", f"{name}.c", "-o", f"{name}.o"], folder)
    return folder / f"{name}.o"


@pytest.mark.quick(2)
@needs_binutils
@each_source
@each_compiler
def test_symbols_and_sections(of, name, tmp_path, tally):
    found = named(name, tally)
    made = source(*of)
    made.write(tmp_path)
    path = object_file(made.made[f"{made.name}.c"], made.name, tmp_path, found)
    given, asked = symbols(path)
    assert f"{made.name}_eval" in given
    assert {symbol for symbol in given if not symbol.startswith(f"{made.name}_")} == set()
    assert asked <= IMPORTED
    sizes = sections(path)
    assert sizes[".text"] > 0
    assert written(sizes) == set()
    assert not FIXED.get(name) or not any(section.startswith(".data") for section in sizes)


@needs_binutils
def test_a_global_a_variable_and_malloc_would_be_seen(tmp_path):
    text = "#include <stdlib.h>\nint count = 1; int sum;\nvoid *more(size_t n) { sum += count++; return malloc(n); }\n"
    path = object_file(text, "flawed", tmp_path, compiler())
    given, asked = symbols(path)
    assert given >= {"count", "sum", "more"}
    assert "malloc" in asked - IMPORTED
    assert written(sections(path)) == {".data", ".bss"}
