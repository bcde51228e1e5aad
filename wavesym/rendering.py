"""Templates: where they are found, and rendering with exactly the keys that a template uses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, meta

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_PACKAGE = Path(__file__).resolve().parent


@cache
def _environment() -> Environment:
    # in a wheel the templates lie inside the package, in a checkout beside it
    places = [_PACKAGE / "templates", _PACKAGE.parent / "templates"]
    return Environment(
        loader=FileSystemLoader([place for place in places if place.is_dir()]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=lambda name: name is not None and name.endswith((".html.j2", ".xml.j2")),  # the rest is C, Python
    )


def render(template: str, context: DataclassInstance) -> str:
    """`template` filled with the fields of `context`. ValueError unless these are just the ones it uses."""
    return "".join(render_stream(template, context))


def render_stream(template: str, context: DataclassInstance) -> Iterator[str]:
    """The same, piece by piece."""
    given: dict[str, Any] = {field.name: getattr(context, field.name) for field in fields(context)}
    used = _used(template)
    if used != given.keys():
        raise ValueError(f"{template}: unused {sorted(given.keys() - used)}, missing {sorted(used - given.keys())}")
    return _environment().get_template(template).generate(given)


def text_of(file: str) -> str:
    """A file among the templates that is none itself, as it stands."""
    environment = _environment()
    assert environment.loader is not None
    return environment.loader.get_source(environment, file)[0]


@cache
def _used(template: str) -> frozenset[str]:
    """The names that a template, or one that it includes, takes from outside."""
    environment = _environment()
    assert environment.loader is not None
    tree = environment.parse(environment.loader.get_source(environment, template)[0])
    names = set(meta.find_undeclared_variables(tree))
    for other in meta.find_referenced_templates(tree):
        assert other is not None  # templates are included by name
        names |= _used(other)
    return frozenset(names)
