"""Templates are given just the keys they use, and numbers read back to the same bits."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jinja2 import UndefinedError, meta

import wavesym
from wavesym.numbers.reals import DOUBLE
from wavesym.rendering import _environment, _template_names, render
from wavesym.targets.literals import c_literals, lines, literal

TEMPLATES = Path(wavesym.__file__).parents[1] / "templates"


def test_a_key_that_is_not_used_is_an_error():
    with pytest.raises(ValueError, match="idle"):
        render("c/header.h.j2", scene=None, idle=None)


def test_a_key_that_is_missing_is_an_error():
    with pytest.raises(ValueError, match="scene"):
        render("c/header.h.j2")


def test_a_field_that_is_missing_is_an_error():
    with pytest.raises(UndefinedError):
        render("c/header.h.j2", scene=object(), more="", under="", bounded=True)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_literals_read_back(value):
    assert float(literal(value)) == value
    assert literal(value) == repr(value)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_what_is_not_finite_is_no_literal(value):
    with pytest.raises(ValueError, match="literal"):
        literal(value)


def test_lines_keep_every_item_and_are_never_empty():
    items = [str(n) for n in range(1000)]
    assert ", ".join(items).split() == " ".join(lines(items)).split()
    assert max(map(len, lines(items))) <= 116
    assert lines([]) == ()
    assert c_literals([], DOUBLE) == ("0",)  # C has no empty array


@pytest.mark.parametrize("path", sorted(TEMPLATES.rglob("*.j2")), ids=lambda path: "/".join(path.parts[-2:]))
def test_what_a_template_takes_is_what_jinja_finds(path):
    """Noted while it is compiled, for every template that there is: in macros, loops and what is included, too."""
    name = path.relative_to(TEMPLATES).as_posix()
    tree = _environment().parse(path.read_text(encoding="utf-8"))
    included = frozenset().union(*(_template_names(other) for other in meta.find_referenced_templates(tree)))
    assert _template_names(name) == meta.find_undeclared_variables(tree) | included
