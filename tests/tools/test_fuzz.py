"""Bytes that a fuzzer found worth keeping, replayed: nothing breaks, and what is broken on purpose is seen."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.test_documents import document
from tests.tools.test_portable import Spoilt
from tools.portable import fuzz
from tools.portable.fuzz import FUZZED, FuzzedProgram
from tools.portable.page import marked_text
from wavesym.running.toolchain import CompilerError

COMPILER = next(filter(shutil.which, ("gcc", "cc", *fuzz.CLANGS)), None)
BY_NAME = {program.name: program for program in FUZZED}
QUICK = "closed_double_values"

pytestmark = pytest.mark.skipif(not COMPILER, reason="no gcc, no clang here")


def replayed(program: FuzzedProgram, folder: Path) -> str:
    """What comes of the bytes that were kept for a driver, with sanitizers where the compiler has them."""
    files = fuzz.unpack_corpus(fuzz.CORPUS, program.driver, folder / "kept")
    assert len(files) > 12
    assert COMPILER
    try:
        run = fuzz.replayer(program, COMPILER, folder)
    except CompilerError:
        run = fuzz.replayer(program, COMPILER, folder, ())
    return fuzz.replay(run, files)


@pytest.mark.slow
@pytest.mark.parametrize("name", BY_NAME)
def test_what_was_kept_breaks_nothing(name, tmp_path):
    assert replayed(BY_NAME[name], tmp_path) == ""


BREAKS = {
    "an index before the first": (QUICK, "while (power > first_power", "while (power >= first_power"),
    "an index too far": ("pieces_double_values", "while (power < lowest)", "while (power <= lowest)"),
    "a row too long": ("pieces_double_values", "counted < many ? 0 : counted - many + 1", "counted"),
    "an edge that belongs to the piece before": ("pieces_double_values", "tau < edge;", "tau <= edge;"),
    "a value out of range": ("closed_double_values", "tau >= 0 && tau <= CLOSED", "tau <= CLOSED"),
    "a phase too far": ("march_double_values", "phase + 1 < CYCLE && t >=", "phase < CYCLE && t >="),
    "a sample too far": ("blocks_double_values", "dtau < 0 ? count - 1 - i : i;", "dtau < 0 ? count - i : i;"),
    "an overflow": ("modes_double_stream", "return wrong ? 2 : 0;", "return 0;"),
    "a refusal that moves": (
        "stream_double_stream",
        "    if (wrong) {\n        return 1;",
        "    state->age += wrong;\n    if (wrong) {\n        return 1;",
    ),
    "an alarm forgotten": ("stream_double_stream", "state->alarm |= !fine;", "state->alarm = !fine;"),
    "an instant too many": (
        "stream_double_stream",
        "k < SIZE; ++k) {\n        at[k] =",
        "k <= SIZE; ++k) {\n        at[k] =",
    ),
    "a stream that should give nothing": ("tuned_double_tuned", "gain[k] = not_a_number();", ""),
    "a bad parameter": (
        "runtime_double_runtime",
        "b->status[set] == 0 && !finite ? 1 :",
        "",
    ),
    "a lane of no size": (
        "runtime_double_runtime",
        "(lane + 1) * RUNTIME_DOUBLE_OUTPUTS",
        "lane * RUNTIME_DOUBLE_OUTPUTS",
    ),
    "a section": (
        "runtime_double_runtime",
        "tau <= RUNTIME_DOUBLE_TAU_MAX && t < from[at + 1];",
        "tau <= RUNTIME_DOUBLE_TAU_MAX;",
    ),
    "a set too many": ("runtime_double_batch", "built = set >= 0 && set <", "built = set <"),
    "a weight": ("runtime_double_batch", "v[k] * v[k]", "v[k]"),
}


@pytest.mark.parametrize(
    "fault", [fault if not k else pytest.param(fault, marks=pytest.mark.slow) for k, fault in enumerate(BREAKS)]
)
def test_what_is_broken_on_purpose_is_seen(fault, tmp_path):
    name, right, wrong = BREAKS[fault]
    program = BY_NAME[name]
    assert replayed(program._replace(subject=Spoilt(program.subject, right, wrong)), tmp_path) != ""


def test_the_page_says_what_was_fuzzed():
    """For minutes each, and nothing was found."""
    rows = [
        line.strip("| ").split(" | ") for line in marked_text(document("docs/portability.md"), "fuzz").splitlines()[4:]
    ]
    assert [row[0] for row in rows] == [program.subject.name for program in FUZZED]
    assert [row[1] for row in rows] == [f"`{program.subject.generate_command}`" for program in FUZZED]
    assert min(int(row[3]) for row in rows) >= 200
    assert [row[5] for row in rows] == ["0"] * len(rows)


@pytest.mark.slow
@pytest.mark.skipif(not fuzz.fuzzer(), reason="no clang with libFuzzer here")
def test_a_fuzzer_finds_a_fault_by_itself(tmp_path):
    name, right, wrong = BREAKS["an index before the first"]
    program = BY_NAME[name]._replace(subject=Spoilt(BY_NAME[name].subject, right, wrong))
    found = fuzz.fuzz(program, fuzz.fuzzer(), tmp_path, tmp_path / "nothing", 30)
    assert any(sanitizer in found.finding for sanitizer in ("AddressSanitizer", "runtime error"))
    assert "bytes " in found.finding
