"""What is proved of generated C, checked and compiled for other machines: that a flaw in a program would be seen."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections import Counter
from itertools import pairwise
from pathlib import Path

import pytest

from tests.support.builds import STRICT, needs_binutils, needs_zig
from tests.test_documents import document
from tools.portable import misra, prove, targets
from tools.portable.answers import cached_answer
from tools.portable.external import absent
from tools.portable.page import marked_text, put, table
from tools.portable.subjects import CHECKED, COMPILED, PROVED
from wavesym.running.toolchain import CompilerError, compiler

PAGE = "docs/portability.md"
PIECES, MODEL, BATCH, BOUND, STREAM = (
    next(subject for subject in PROVED if (subject.name, subject.driver) == key)
    for key in (
        ("pieces_double", "values"),
        ("runtime_brief_double", "runtime"),
        ("runtime_brief_double", "batch"),
        ("runtime_brief_double", "bound"),
        ("stream_double", "stream"),
    )
)
(SINGLE,) = (subject for subject in COMPILED if subject.name == "pieces_single")
INCLUDED = '#include "pieces_double.h"'
NATIVE = targets.TARGETS[0]

needs_prover = pytest.mark.skipif(bool(absent(prove.TOOL)), reason="no Frama-C here")
needs_checker = pytest.mark.skipif(bool(absent(misra.TOOL)), reason="no cppcheck here")


class Spoilt:
    """A subject whose program is changed."""

    def __init__(self, subject, right, wrong):
        self.subject, self.right, self.wrong = subject, right, wrong

    def __getattr__(self, name):
        return getattr(self.subject, name)

    def files(self):
        made = self.subject.files()
        file = f"{self.subject.name}.c"
        assert self.right in made[file]
        return made | {file: made[file].replace(self.right, self.wrong)}


def written(subject, folder):
    for file, text in subject.files().items():
        (folder / file).write_text(text)
    return subject


def proved(subject, folder):
    """What the prover says of it, with what it is told besides."""
    for file, text in subject.files().items():
        (folder / file).write_text(prove.annotate(subject, text))
    return prove.verdict(subject, 1, "gcc_x86_64", folder)


def rows_of(name, head):
    """The lines of a table on the page, by the first line of which it is found."""
    found = marked_text(document(PAGE), name).partition(table(head, []))[2].partition("\n\n")[0]
    return [line.strip("| ").split(" | ") for line in found.splitlines()]


def test_the_page_says_what_was_proved():
    rows = rows_of("prove", prove.HEAD)
    assert [row[0] for row in rows] == [subject.name for subject in PROVED]
    assert {row[-1] for row in rows} == {"0"}


FUNCTIONS = ("-inline-calls", "-eva-slevel-function", "-eva-split-return-function")


@pytest.mark.parametrize("subject", {(one.name, one.driver): one for one in PROVED}.values(), ids=lambda one: one.name)
def test_the_prover_is_told_of_functions_that_there_are(subject):
    """It refuses a program, and takes no notice of an annotation, where there is none of that name."""
    command = prove.command(subject)
    told = {
        name.partition(":")[0]
        for option, names in pairwise(command)
        if option in FUNCTIONS
        for name in names.split(",")
    }
    text = subject.files()[f"{subject.name}.c"]
    defined = set(re.findall(r"(?m)^\w.*?\b(?:OF\()?(\w+)\)?\([^;\n]*$", text)) | {"main"}
    assert told <= defined | {f"{name}_batch" for name in re.findall(r"(?m)^\w.*?\bOF\((\w+)\)\(", text)}
    annotated = prove.annotate(subject, text)
    for function in prove.SPLITS.get(subject.effort, {}):
        assert re.search(rf"{function}\)?\([^{{;]*\{{\n    //@ split", annotated)
    for function in prove.PROMISES.get(subject.effort, {}):
        assert re.search(rf"/\*@ ensures [^\n]*\nstatic int {function}\(", annotated)


def test_the_page_has_a_reason_for_each_rule():
    rows = rows_of("misra", misra.HEAD)
    assert {rule: reason for rule, _, reason in rows} == misra.deviations()


def test_each_finding_is_in_the_list_of_functions():
    lines = [line.split(",") for line in document("docs/misra.csv").splitlines()[1:]]
    listed = Counter()
    for rule, _, _, findings in lines:
        listed[rule] += int(findings)
    assert listed == {rule: int(findings) for rule, findings, _ in rows_of("misra", misra.HEAD)}


def test_the_page_has_every_machine():
    rows = rows_of("targets", targets.HEAD)
    assert {(row[0], row[1]) for row in rows} == {
        (target.name, subject.name)
        for target in targets.TARGETS
        for subject in COMPILED
        if target.hosted_triple or not subject.calls_exp
    }
    assert {row[2] for row in rows} == {"yes"}
    assert {row[6] for row in rows} == {"0"}


def test_the_page_has_a_line_for_each_machine():
    lines = rows_of("targets", targets.STATUS_HEAD)
    assert [line[0] for line in lines] == [target.name for target in targets.TARGETS]
    for name, compiled, _, _ in lines:
        own = [row for row in rows_of("targets", targets.HEAD) if row[0] == name]
        assert compiled == f"{len(own)} of {len(own)}"


def test_a_table_takes_the_place_of_the_one_before(tmp_path: Path):
    page = tmp_path / "page.txt"
    page.write_text("a\n<!-- written by `make prove` -->\nold\n<!-- end -->\nb\n")
    put(page, "prove", table(("x", "y"), [("1", "2")]))
    assert marked_text(page.read_text(), "prove") == "| x | y |\n| --- | --- |\n| 1 | 2 |\n"
    assert page.read_text().startswith("a\n")
    assert page.read_text().endswith("-->\nb\n")
    with pytest.raises(ValueError, match="misra"):
        put(page, "misra", "")


def test_a_finding_that_nobody_reviewed_is_told():
    found = [misra.MisraFinding("10.4", "a.c:1", ""), misra.MisraFinding("21.3", "a.c:2", "f")]
    assert misra.unreviewed_findings(found, {"10.4": "so"}) == ["a.c:2, f: 21.3 is not kept, and no deviation says why"]


def test_a_finding_is_in_the_function_around_it():
    lines = [
        "enum { A = sizeof(int) };",
        "static const real *g(int a,",
        "    int b)",
        "{",
        "    a;",
        "}",
        "int x[] = {",
    ]
    assert [misra.function_at(lines, number) for number in (1, 2, 5, 6, 7)] == ["", "g", "g", "g", ""]


def test_an_answer_is_asked_for_once_unless_the_question_changes(tmp_path):
    asked = []

    def ask(question, answer, **how):
        return cached_answer(tmp_path / "new", question, lambda: asked.append(question) or answer, **how)

    assert (ask(["a", "b"], [1, "x"]), ask(["a", "b"], [2]), ask(["ab"], [3])) == ([1, "x"], [1, "x"], [3])
    assert asked == [["a", "b"], ["ab"]]
    assert (ask(["c"], None, worth=bool), ask(["c"], [4], worth=bool)) == (None, [4])


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("gcc"), reason="no gcc here")
@pytest.mark.parametrize("optimised", ["-O1", "-O2", "-O3", "-Os"])
@pytest.mark.parametrize("subject", COMPILED, ids=lambda subject: subject.name)
def test_no_optimisation_makes_a_warning(subject, optimised, tmp_path):
    """What is seen of a program depends on what is put into what."""
    written(subject, tmp_path)
    command = ["gcc", "-std=c99", optimised, *STRICT, "-c", f"{subject.name}.c", "-o", "made.o"]
    made = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (made.returncode, made.stderr) == (0, "")


@needs_prover
@pytest.mark.slow
@pytest.mark.parametrize(
    ("subject", "right", "wrong"),
    [
        (PIECES, "tau == tau && tau >= 0 && tau <= PIECES_DOUBLE_TAU_MAX", "tau >= 0"),
        (PIECES, "while (end < s->count && before", "while (before"),
        (PIECES, "while (power < lowest)", "while (power <= lowest)"),
        (MODEL, "above[j] = y[j] = at_first[j] = at_last[j] = ZERO;", ""),  # read, and never set
        (MODEL, "b->place += (size_t)", "b->place += 2 * (size_t)"),
        (MODEL, "event < RUNTIME_BRIEF_DOUBLE_EVENTS && event_window", "event_window"),
        (BATCH, "set >= 0 && set <", "set <"),
        (STREAM, "breakpoints < STREAM_DOUBLE_BREAKPOINTS", "breakpoints <= STREAM_DOUBLE_BREAKPOINTS"),
        (STREAM, "if (silent <= DEEPEST)", "if (silent >= 0)"),  # goes up for ever
        (STREAM, "slot < 0 ? slot + slots[number] : slot", "slot"),  # into what is before waves
        (BOUND, "x_size[RUNTIME_BRIEF_DOUBLE_WIDEST], s[", "x_size[RUNTIME_BRIEF_DOUBLE_WIDEST - 1], s["),
    ],
)
def test_the_prover_sees_what_is_wrong(subject, right, wrong, tmp_path):
    """In programs without an alarm of their own: one of many would say nothing."""
    (stated,) = (
        row[-1]
        for row, one in zip(rows_of("prove", prove.HEAD), PROVED, strict=True)
        if (one.name, one.driver) == (subject.name, subject.driver)
    )
    assert stated == "0"
    found = proved(Spoilt(subject, right, wrong), tmp_path)
    assert found.alarms is not None
    assert found.alarms > 0


@needs_prover
@pytest.mark.slow
def test_nothing_undefined_is_found_in_one_program(tmp_path):
    found = proved(PIECES, tmp_path)
    assert (found.alarms, found.alarm_texts) == (0, [])


@needs_checker
@pytest.mark.slow
def test_what_the_checker_finds_was_reviewed(tmp_path):
    found = [finding for subject in CHECKED for finding in misra.findings(subject, tmp_path)]
    assert found
    assert misra.unreviewed_findings(found, misra.deviations()) == []


@needs_checker
@pytest.mark.slow
def test_the_checker_sees_a_rule_that_is_broken(tmp_path):
    found = misra.findings(Spoilt(PIECES, INCLUDED, f"{INCLUDED}\n#include <stdio.h>"), tmp_path)
    assert misra.unreviewed_findings(found, misra.deviations())


@needs_zig
@needs_binutils
@pytest.mark.slow
def test_a_program_is_taken_alone_and_its_selftest_passes(tmp_path):
    size = targets.compile_bare(written(SINGLE, tmp_path), NATIVE, tmp_path)
    assert size.text > 0
    assert size.rodata > 0
    assert size.data == 0
    if sys.platform == "linux":
        assert targets.selftest(SINGLE, NATIVE, tmp_path) == "passes"


@needs_zig
@needs_binutils
@pytest.mark.slow
@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("real sum = *power;", "real sum = (real)(2.0 * *power);"),  # on doubles
        ("enum { GRIDS", "#include <stdio.h>\nenum { GRIDS"),  # from a C library
        ("real sum = *power;", "real sum = *power; int unused;"),
        ("real sum = *power;", "extern real other(real);\nreal sum = other(*power);"),
    ],
)
def test_what_a_small_machine_lacks_is_refused(right, wrong, tmp_path):
    with pytest.raises(CompilerError):
        targets.compile_bare(written(Spoilt(SINGLE, right, wrong), tmp_path), NATIVE, tmp_path)


@needs_zig
@needs_binutils
@pytest.mark.slow
def test_data_that_can_be_written_are_refused(tmp_path):
    spoilt = Spoilt(SINGLE, "enum { GRIDS", "int pieces_single_flaw = 1;\nenum { GRIDS")
    with pytest.raises(CompilerError, match="4 bytes of data that can be written"):
        targets.compile_bare(written(spoilt, tmp_path), NATIVE, tmp_path)


def test_programs_refuse_fast_math():
    for subject in (PIECES, SINGLE):
        text = subject.files()[f"{subject.name}.c"]
        guard = f"!defined({subject.name.upper()}_ALLOW_FAST_MATH)"
        assert guard in text
        assert re.search(r"#error .*bounds of errors no longer hold", text)


@pytest.mark.slow
@pytest.mark.parametrize("flag", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
@pytest.mark.parametrize("subject", list({s.name: s for s in CHECKED + COMPILED}.values()), ids=lambda s: s.name)
def test_no_program_compiles_so_unless_it_is_told_to(subject, flag, tmp_path):
    name = written(subject, tmp_path).name
    compile_ = ["-std=c99", flag, "-c", f"{name}.c", "-o", "made.o"]
    with pytest.raises(CompilerError, match="bounds of errors no longer hold, nor NaN out of range"):
        compiler().run(compile_, tmp_path)
    compiler().run([*compile_, f"-D{name.upper()}_ALLOW_FAST_MATH"], tmp_path)
