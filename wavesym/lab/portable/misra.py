"""What cppcheck says of every program against the rules of MISRA C:2012, next to the deviations that were reviewed."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from wavesym.lab.portable.subjects import PortableProgram
from wavesym.lab.portable.tools import started
from wavesym.rendering import text_of

TOOL = "cppcheck"
HEAD = ("rule", "findings", "why it is left")
REVIEWED = "proof/deviations.txt"
_COMMAND = (
    TOOL,
    "--addon=misra",
    "--std=c99",
    "--quiet",
    "--suppress=missingIncludeSystem",
    "--template={file}:{line}:{id}",
)
_SECONDS = 300.0


def deviations() -> dict[str, str]:
    """The rules that programs do not keep, each with the reason, as they stand in templates/proof/deviations.txt."""
    lines = (line.partition(" ") for line in text_of(REVIEWED).splitlines() if line and not line.startswith("#"))
    return {rule: reason.strip() for rule, _, reason in lines}


def findings(subject: PortableProgram, folder: Path) -> list[tuple[str, str]]:
    """What the checker finds in a program: the rule, and where."""
    for file, text in subject.files().items():
        (folder / file).write_text(text, encoding="utf-8")
    said = started([*_COMMAND, f"{subject.name}.c"], folder, _SECONDS)
    lines = re.findall(r"^(\S+:\d+):(\S+)$", said.errors, re.MULTILINE)
    return [(rule.removeprefix("misra-c2012-"), place) for place, rule in lines]


def rows(subjects: Sequence[PortableProgram], folder: Path, failed: list[str]) -> Iterator[tuple[str, ...]]:
    """A row for each rule; findings that no deviation allows are added to `failed`, and deviations without one."""
    found = [finding for subject in subjects for finding in findings(subject, folder)]
    allowed = deviations()
    failed += unreviewed(found, allowed)
    counted = Counter(rule for rule, _ in found)
    failed += [
        f"rule {rule}: a deviation is listed, and there is no finding" for rule in allowed.keys() - counted.keys()
    ]
    for rule in sorted(counted, key=_in_order):
        yield rule, str(counted[rule]), allowed.get(rule, "not reviewed")


def unreviewed(found: Iterable[tuple[str, str]], allowed: dict[str, str]) -> list[str]:
    """The findings that no deviation allows."""
    return [f"{place}: {rule} is not kept, and no deviation says why" for rule, place in found if rule not in allowed]


def _in_order(rule: str) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", rule))
