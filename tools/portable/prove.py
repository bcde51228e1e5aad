"""Frama-C's Eva on every program: it covers all that C can do for any argument, and alarms where that is undefined.

That is: access out of bounds or of what was never set, overflow of integers, of conversions to integers, of shifts,
comparison of pointers into different things. Numbers may be any, NaN and infinities included: these are no alarms.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from tools.portable.answers import cached_answer
from tools.portable.external import run_command, version
from tools.portable.subjects import PortableProgram

TOOL = "frama-c"
HEAD = ("program", "made by", "called, any argument", "counts", "statements reached", "alarms")
MACHINES = ("gcc_x86_64",)
"""Layouts of data: integers, long and pointers as on these machines."""

_SECONDS = 600.0
_OPTIONS = (
    *("-eva", "-eva-no-show-progress", "-eva-msg-key=-final-states,-initial-state"),
    *("-warn-special-float", "none"),
)
# what the driver repeats for ever is joined at once; loops of the program are unrolled
_FOR_EVER = ("-eva-slevel-function", "main:0")
# every loop, for each degree by itself
_TO_THE_END = (
    *("-eva-precision", "0", "-eva-slevel", "20000", "-eva-ilevel", "64"),
    *("-eva-split-return", "auto"),
)
# what is refused has no laws, nor has a batch of none
_REFUSED_IS_REFUSED = ("-eva-split-return-function", "check_laws:0,check_batch:0")
_WITH_ITS_DEGREE = ",".join(
    f"{name}{lanes}" for lanes in ("", "_batch") for name in ("integrate", "clear", "add", "add_series", "gather")
)
# all degrees at once: what is short or counted in tables is unrolled, windows and events by their functions
_AT_ONCE = ("-eva-precision", "0", "-eva-auto-loop-unroll", "128", "-eva-ilevel", "128", "-eva-plevel", "400")
_ONE_BY_ONE = (
    "main:100,name_build_with:50,start_model:50,check_laws:50,march_all:200,next_window:100,apply_loads:100,march:100,"
    "accumulate_term:100,end_value:100,name_model_sample:100,sample_series:100,run:100,output_block:100,total_of:20"
)
# where a stream counts the ends of joints
_JOINT_BY_JOINT = "main:0,scatter:100,change_loads:100"
_EFFORTS = {
    "usual": ("-eva-precision", "2", *_FOR_EVER),
    "more": ("-eva-precision", "3", *_FOR_EVER),
    "followed": _TO_THE_END,
    # of models
    "unrolled": (*_TO_THE_END, "-inline-calls", "integrate", *_REFUSED_IS_REFUSED),
    # of chains: what is asked of a copy of the degree is known of the degree
    "equal": (*_TO_THE_END, "-inline-calls", _WITH_ITS_DEGREE, *_REFUSED_IS_REFUSED, "-eva-domains", "equality"),
    # of models of any degree
    "bounds": (
        *_AT_ONCE,
        *("-eva-split-return", "auto", "-eva-split-return-function", "check_laws:0,start_model:0"),
        *("-eva-slevel-function", _ONE_BY_ONE),
    ),
    # tables that are made at run time: short loops by themselves, up to the terms of a power series
    "made": ("-eva-precision", "0", "-eva-auto-loop-unroll", "20", "-eva-slevel-function", _JOINT_BY_JOINT),
}
PROMISES = {
    "made": {
        "slot_of": "0 <= \\result < NAME_SLOTS",
        "slot_after": "NAME_SLOTS <= \\result < NAME_SLOTS + NAME_BREAKPOINTS * NAME_ENTRIES",
    }
}
"""Of an effort what functions return, which is to be proved where a pointer would go from one array into the next."""
SPLITS = {
    "unrolled": {"accumulate_term": "degree"},
    "bounds": {"run": "section", "accumulate_term": "degree"},
}
"""Of an effort the functions that are followed for each value of one of their numbers by itself."""


class ProofVerdict(NamedTuple):
    """Of one run: alarms (None: it did not come to an end), statements reached of those there are, and each alarm."""

    alarms: int | None
    statements_reached: int
    statements: int
    alarm_texts: list[str]


def command(subject: PortableProgram) -> list[str]:
    """The prover with the options that a program needs."""
    return [TOOL, *_OPTIONS, *(subject.instantiate(option) for option in _EFFORTS[subject.effort])]


def annotate(subject: PortableProgram, text: str) -> str:
    """C with what tells the prover where to follow each value by itself; others read comments there."""
    for function, number in SPLITS.get(subject.effort, {}).items():
        head = rf"(?m)^(static (?:BY_ITSELF )?void (?:OF\()?{function}\)?\([^{{;]*\{{\n)"
        text = re.sub(head, rf"\g<1>    //@ split {number};\n    ;\n", text)
    for function, promise in PROMISES.get(subject.effort, {}).items():
        contract = f"/*@ ensures {subject.instantiate(promise)}; */"
        text = text.replace(f"\nstatic int {function}(", f"\n{contract}\nstatic int {function}(")
    return text


def verdict(subject: PortableProgram, count: int, machine: str, folder: Path) -> ProofVerdict:
    """Prove a program, whose files are in `folder`, under its driver."""
    driver = f"{subject.name}_{subject.driver}_{count}_{machine}_driver.c"
    (folder / driver).write_text(subject.driver_text(count), encoding="utf-8")
    result = run_command([*command(subject), "-machdep", machine, driver, f"{subject.name}.c"], folder, _SECONDS)
    found = re.search(r"(\d+) alarms? generated", result.output)
    covered = re.search(r"(\d+) statements reached \(out of (\d+)\)", result.output)
    if result.status != 0 or not found or not covered:
        return ProofVerdict(None, 0, 0, [result.errors or result.output[-500:]])
    alarm_texts = re.findall(r"^\[eva:alarm\] (.*?): Warning:\s*(.*(?:\n  .*)*)", result.output, re.MULTILINE)
    alarms = [f"{place}: {' '.join(what.split())}" for place, what in alarm_texts]
    broken = sum("got status" in alarm for alarm in alarms)  # promises, which are not among those that it counts
    return ProofVerdict(int(found[1]) + broken, int(covered[1]), int(covered[2]), alarms)


def key(subject: PortableProgram) -> tuple[str, ...]:
    """The first cells of its row, which tell it from others."""
    called = ", ".join(f"`{name}`" for name in subject.called_functions)
    return (subject.name, f"`{subject.generate_command}`", called)


def rows(
    subjects: Sequence[PortableProgram], folder: Path, kept_in: Path, failed: list[str]
) -> Iterator[tuple[str, ...]]:
    """A row for each program, its counts together; what was not proved is added to `failed`."""
    tool = version(TOOL)
    texts = {
        subject.name: {file: annotate(subject, text) for file, text in subject.files().items()} for subject in subjects
    }
    for files in texts.values():
        for file, text in files.items():
            (folder / file).write_text(text, encoding="utf-8")

    def ask(subject: PortableProgram, machine: str, count: int) -> ProofVerdict:
        question = (tool, *command(subject), machine, subject.driver_text(count), *texts[subject.name].values())

        def answer() -> ProofVerdict:
            return verdict(subject, count, machine, folder)

        return ProofVerdict(*cached_answer(kept_in, question, answer, worth=lambda found: found.alarms is not None))

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        runs = [
            [pool.submit(ask, subject, machine, count) for machine in MACHINES for count in subject.counts or (0,)]
            for subject in subjects
        ]
        for subject, run in zip(subjects, runs, strict=True):
            found = [one.result() for one in run]
            alarms = [one.alarms for one in found]
            failed += [f"{subject.name}, {subject.driver}: {line}" for one in found for line in one.alarm_texts]
            yield (
                *key(subject),
                ", ".join(map(str, subject.counts)) or "",
                f"{max(one.statements_reached for one in found)} of {max(one.statements for one in found)}",
                "not finished" if None in alarms else str(max(one for one in alarms if one is not None)),
            )
