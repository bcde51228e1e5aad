"""What cppcheck says of every program against the rules of MISRA C:2012, next to the deviations that were reviewed."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from tools.portable.answers import cached_answer
from tools.portable.external import run_command, version
from tools.portable.subjects import PortableProgram

TOOL = "cppcheck"
HEAD = ("rule", "findings", "why it is left")
LIST = "misra.csv"
LIST_HEAD = ("rule", "file", "function", "findings")
REVIEWED = Path(__file__).with_name("proof") / "deviations.txt"
_COMMAND = (
    TOOL,
    "--addon=misra",
    "--std=c99",
    "--quiet",
    "--force",  # all configurations: programs with many parts have more than cppcheck looks at by itself
    "--suppress=missingIncludeSystem",
    "--template={file}:{line}:{id}",
)
_SECONDS = 600.0
_FUNCTION = re.compile(r"(?!enum|typedef|struct)[A-Za-z](?:[\w *]*[ *])?(\w+)\([^;=]*$")


def deviations() -> dict[str, str]:
    """The rules that programs do not keep, each with the reason, as they stand in proof/deviations.txt."""
    lines = (
        line.partition(" ")
        for line in REVIEWED.read_text(encoding="utf-8").splitlines()
        if line and not line.startswith("#")
    )
    return {rule: reason.strip() for rule, _, reason in lines}


class MisraFinding(NamedTuple):
    """A rule that is not kept, the line of the program, and the function it is in, "" outside of all."""

    rule: str
    place: str
    function: str


def findings(subject: PortableProgram, folder: Path) -> list[MisraFinding]:
    """What the checker finds in a program."""
    texts = {file: text.splitlines() for file, text in subject.files().items()}
    for file, lines in texts.items():
        (folder / file).write_text("\n".join((*lines, "")), encoding="utf-8")
    result = run_command([*_COMMAND, f"{subject.name}.c"], folder, _SECONDS)
    if result.status != 0:
        raise RuntimeError(f"{subject.name}: {result.errors[-500:]}")
    found = re.findall(r"^(\S+):(\d+):(\S+)$", result.errors, re.MULTILINE)
    return [
        MisraFinding(
            rule.removeprefix("misra-c2012-"),
            f"{file}:{line}",
            function_at(texts[file], int(line)).replace(f"{subject.name}_", "name_"),
        )
        for file, line, rule in found
    ]


def function_at(lines: Sequence[str], number: int) -> str:
    """The function that a line, counted from 1, is in."""
    for place in range(number - 1, -1, -1):
        if start := _FUNCTION.match(lines[place]):
            return start[1]
        if lines[place].startswith("}") and place < number - 1:
            break
    return ""


def all_findings(subjects: Sequence[PortableProgram], folder: Path, kept_in: Path) -> list[MisraFinding]:
    """The findings in all programs, each looked at by itself."""
    tool = version(TOOL)

    def findings_of(subject: PortableProgram) -> list[MisraFinding]:
        own = folder / subject.name
        own.mkdir()
        question = (tool, *_COMMAND, _FUNCTION.pattern, *subject.files().values())
        return [MisraFinding(*found) for found in cached_answer(kept_in, question, lambda: findings(subject, own))]

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return [finding for found in pool.map(findings_of, subjects) for finding in found]


def rows(found: Sequence[MisraFinding], failed: list[str]) -> Iterator[tuple[str, ...]]:
    """A row for each rule; findings that no deviation allows are added to `failed`, and deviations without one."""
    allowed = deviations()
    failed += unreviewed_findings(found, allowed)
    counted = Counter(finding.rule for finding in found)
    failed += [
        f"rule {rule}: a deviation is listed, and there is no finding" for rule in allowed.keys() - counted.keys()
    ]
    for rule in sorted(counted, key=_in_order):
        yield rule, str(counted[rule]), allowed.get(rule, "not reviewed")


def by_function(found: Iterable[MisraFinding]) -> str:
    """How many there are of each rule in each function of each file, as CSV."""
    counted = Counter((finding.rule, finding.place.partition(":")[0], finding.function) for finding in found)
    lines = sorted(counted, key=lambda key: (_in_order(key[0]), key))
    return "".join(f"{','.join(line)}\n" for line in (LIST_HEAD, *((*key, str(counted[key])) for key in lines)))


def unreviewed_findings(found: Iterable[MisraFinding], allowed: dict[str, str]) -> list[str]:
    """The findings that no deviation allows."""
    return [
        f"{finding.place}, {finding.function or 'outside of functions'}: {finding.rule} is not kept, and no deviation "
        "says why"
        for finding in found
        if finding.rule not in allowed
    ]


def _in_order(rule: str) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", rule))
