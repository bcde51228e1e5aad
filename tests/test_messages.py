"""Messages of errors: whoever reads one learns what is too much, how much it is, how much may be, and what helps."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import wavesym

PACKAGE = Path(wavesym.__file__).parent
COSTS = {"CostError", "_TooLarge"}
KEY = (
    r"(output|output\.until|load|frequency|system|system\.(m|parts)|"
    r"--below|--count|--intervals|--peaks|--points|--to|--until|\{asked\})"
)
FORM = re.compile(rf"{KEY}: .+ expected.* \(.+ helps?\)")
PASSED_ON = re.compile(r".*\{error\} \(.+ helps?\)")  # the sentence of another error, which says how much


def text(message: ast.expr) -> str:
    """A text as it is written, and {…} for what is put into it."""
    match message:
        case ast.Constant(str(value)):
            return value
        case ast.JoinedStr(parts):
            return "".join(text(part) for part in parts)
        case ast.FormattedValue(value):
            return f"{{{ast.unparse(value)}}}"
    return "{}"


def costs(source: str) -> Iterator[str]:
    """The messages of all errors about cost that a source makes."""
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Call(ast.Name(name), [message]) if name in COSTS:
                yield text(message)


def complete(message: str) -> bool:
    """Whether it has a key, a size, a limit, and help."""
    if PASSED_ON.fullmatch(message):
        return True
    left = message.replace("{asked}", "", 1)
    return bool(FORM.fullmatch(message)) and "at most" in left and left.count("{") > 1 and ";" not in message


SOURCES = [path for path in sorted(PACKAGE.rglob("*.py")) if "CostError(" in path.read_text(encoding="utf-8")]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_an_error_about_cost_names_its_quantity_the_limit_and_what_helps(path: Path) -> None:
    for message in costs(path.read_text(encoding="utf-8")):
        assert complete(message), message


def test_there_are_such_errors() -> None:
    assert sum(len(list(costs(path.read_text(encoding="utf-8")))) for path in SOURCES) > 12


@pytest.mark.parametrize(
    "message",
    [
        '"output.until: too far"',
        'f"output.until: {size} bytes, at most {most} expected"',
        'f"{size} bytes, at most {most} expected (a shorter horizon helps)"',
        'f"load: many bytes, at most {most} expected (fewer samples help)"',
        'f"load: {size} bytes would be too many (fewer samples help)"',
        'f"load: {size} bytes, at most {most} expected; more (fewer samples help)"',
    ],
)
def test_an_incomplete_message_is_seen(message: str) -> None:
    (found,) = costs(f"raise CostError({message})")
    assert not complete(found)
