"""Frama-C's Eva on every program: it covers all that C can do for any argument, and alarms where that is undefined.

That is: access out of bounds or of what was never set, overflow of integers, of conversions to integers, of shifts,
comparison of pointers into different things. Numbers may be any, NaN and infinities included: these are no alarms.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from wavesym.lab.portable.subjects import PortableProgram
from wavesym.lab.portable.tools import started

TOOL = "frama-c"
HEAD = ("program", "made by", "called, any argument", "counts", "statements reached", "alarms")
MACHINES = ("gcc_x86_64",)
"""Layouts of data: integers, long and pointers as on these machines."""

_SECONDS = 900.0
_OPTIONS = (
    *("-eva", "-eva-no-show-progress", "-eva-msg-key=-final-states,-initial-state"),
    *("-warn-special-float", "none"),
    # what the driver repeats for ever is joined at once; loops of the program are unrolled
    *("-eva-slevel-function", "main:0"),
)


class ProofVerdict(NamedTuple):
    """Of one run: alarms (None: it did not come to an end), statements reached of those there are, and each alarm."""

    alarms: int | None
    reached: int
    statements: int
    told: list[str]


def verdict(subject: PortableProgram, count: int, machine: str, folder: Path) -> ProofVerdict:
    """Prove a program, whose files are in `folder`, under its driver."""
    driver = f"{subject.name}_{count}_{machine}_driver.c"
    (folder / driver).write_text(subject.driven(count), encoding="utf-8")
    command = [
        TOOL,
        "-eva-precision",
        str(subject.precision),
        *_OPTIONS,
        "-machdep",
        machine,
        driver,
        f"{subject.name}.c",
    ]
    said = started(command, folder, _SECONDS)
    found = re.search(r"(\d+) alarms? generated", said.out)
    covered = re.search(r"(\d+) statements reached \(out of (\d+)\)", said.out)
    if said.status != 0 or not found or not covered:
        return ProofVerdict(None, 0, 0, [said.errors or said.out[-500:]])
    told = re.findall(r"^\[eva:alarm\] (.*?): Warning:\s*(.*(?:\n  .*)*)", said.out, re.MULTILINE)
    alarms = [f"{place}: {' '.join(what.split())}" for place, what in told]
    return ProofVerdict(int(found[1]), int(covered[1]), int(covered[2]), alarms)


def rows(subjects: Sequence[PortableProgram], folder: Path, failed: list[str]) -> Iterator[tuple[str, ...]]:
    """A row for each program, its counts together; what was not proved is added to `failed`."""
    for subject in subjects:
        for file, text in subject.files().items():
            (folder / file).write_text(text, encoding="utf-8")

    def verdicts(subject: PortableProgram) -> list[ProofVerdict]:
        return [verdict(subject, count, machine, folder) for machine in MACHINES for count in subject.counts or (0,)]

    with ThreadPoolExecutor() as started_at_once:
        every = list(started_at_once.map(verdicts, subjects))
    for subject, found in zip(subjects, every, strict=True):
        alarms = [one.alarms for one in found]
        failed += [f"{subject.name}, {subject.driver}: {line}" for one in found if one.alarms != 0 for line in one.told]
        yield (
            subject.name,
            f"`{subject.asked}`",
            ", ".join(f"`{name}`" for name in subject.called),
            ", ".join(map(str, subject.counts)) or "",
            f"{min(one.reached for one in found)} of {max(one.statements for one in found)}",
            "not finished" if None in alarms else str(max(one for one in alarms if one is not None)),
        )
