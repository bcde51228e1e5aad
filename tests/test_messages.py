"""Messages of errors: what is wrong, and what to write; where too much is asked for how much, the limit, what helps."""

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
    r"--below|--count|--intervals|--peaks|--points|--range|--to|--until|\{key\})"
)
FORM = re.compile(rf"{KEY}: .+, the limit.* is .+ \(.+ helps?\)")
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
    left = message.replace("{key}", "", 1)
    return bool(FORM.fullmatch(message)) and left.count("{") > 1 and ";" not in message


SOURCES = [path for path in sorted(PACKAGE.rglob("*.py")) if "CostError(" in path.read_text(encoding="utf-8")]


RAISED = re.compile(r"((?<!Meaningless)Error|wrong|damaged|refused)$")
STALE = re.compile(r"\b(expected|given)(\b|,)")
"""How messages once said it: what was there, and what should be, but neither what is wrong nor what to write."""


def raised(source: str) -> Iterator[str]:
    """The texts of all errors that a source makes: calls of exceptions and of what makes them."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and RAISED.search(ast.unparse(node.func)):
            for argument in node.args:
                if isinstance(argument, ast.JoinedStr | ast.Constant):
                    yield re.sub(r"\{[^{}]*\}", "", text(argument))


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_a_message_says_what_is_wrong_not_what_was_given_and_expected(path: Path) -> None:
    assert [message for message in raised(path.read_text(encoding="utf-8")) if STALE.search(message)] == []


def test_a_stale_message_is_seen() -> None:
    (message,) = raised('raise wrong(f"{value} given, a list expected")')
    assert STALE.search(message)


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
        'f"output.until: {size} bytes, the limit is {most}"',
        'f"{size} bytes, the limit is {most} (a shorter horizon helps)"',
        'f"load: many bytes, the limit is {most} (fewer samples help)"',
        'f"load: {size} bytes would be too many (fewer samples help)"',
        'f"load: {size} bytes, the limit is {most}; more (fewer samples help)"',
    ],
)
def test_an_incomplete_message_is_seen(message: str) -> None:
    (found,) = costs(f"raise CostError({message})")
    assert not complete(found)
