"""Templates: where they are found, and rendering with exactly the keys that a template uses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from jinja2.compiler import CodeGenerator
from jinja2.meta import find_referenced_templates

if TYPE_CHECKING:
    from jinja2.compiler import Frame
    from jinja2.nodes import Template

_PACKAGE = Path(__file__).resolve().parent


class _Noting(CodeGenerator):
    """Compiles a template, and notes while it does so what `jinja2.meta` would compile it once more for."""

    environment: _Templates

    def visit_Template(self, node: Template, frame: Frame | None = None) -> None:
        self._taken: set[str] = set()
        super().visit_Template(node, frame)
        if self.name is not None:  # of a file, that is
            self.environment.taken[self.name] = self._taken - set(self.environment.globals)
            others = [other for other in find_referenced_templates(node) if other is not None]
            self.environment.included[self.name] = others

    def enter_frame(self, frame: Frame) -> None:
        super().enter_frame(frame)
        loads = frame.symbols.loads.values()
        self._taken |= {name for action, name in loads if action == "resolve" and name is not None}


class _Templates(Environment):
    """Templates, and of each that was compiled the names that it takes from outside, and the templates it includes."""

    code_generator_class = _Noting

    def __init__(self, places: Sequence[Path]) -> None:
        super().__init__(
            loader=FileSystemLoader(places),
            undefined=StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
            keep_trailing_newline=True,
            autoescape=lambda name: (
                name is not None and name.endswith((".html.j2", ".xml.j2"))
            ),  # the rest is C, Python
        )
        self.taken: dict[str, set[str]] = {}
        self.included: dict[str, list[str]] = {}


@cache
def _environment() -> _Templates:
    # in a wheel the templates lie inside the package, in a checkout beside it
    places = [_PACKAGE / "templates", _PACKAGE.parent / "templates"]
    return _Templates([place for place in places if place.is_dir()])


def render(template: str, /, **given: Any) -> str:
    """`template` filled with what is given by name. ValueError unless these are just the names that it uses."""
    return "".join(render_stream(template, **given))


def render_stream(template: str, /, **given: Any) -> Iterator[str]:
    """The same, piece by piece."""
    used = _template_names(template)
    if used != given.keys():
        raise ValueError(f"{template}: unused {sorted(given.keys() - used)}, missing {sorted(used - given.keys())}")
    return _environment().get_template(template).generate(given)


def text_of(file: str) -> str:
    """A file among the templates that is none itself, as it stands."""
    environment = _environment()
    assert environment.loader is not None
    return environment.loader.get_source(environment, file)[0]


@cache
def _template_names(template: str) -> frozenset[str]:
    """The names that a template, or one that it includes, takes from outside."""
    environment = _environment()
    environment.get_template(template)
    return frozenset(environment.taken[template]).union(*map(_template_names, environment.included[template]))
