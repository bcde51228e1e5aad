"""What `generate` would write of a model, for tests: texts by file name."""

from __future__ import annotations

from wavesym.mechanics.model import Model
from wavesym.programs import making
from wavesym.programs.form import Form
from wavesym.programs.program import Program
from wavesym.programs.request import Request
from wavesym.targets import files as written


def files(model: Model, language: str = "c", *request: object, **named: object) -> dict[str, str]:
    """All files of the program that is asked for by a `Request` of these fields."""
    return written.files(
        making.make(model, Request(*request, **named), tested=written.has_selftest(language)), language
    )


def program_files(model: Model, form: Form, language: str, *, tested: bool = False) -> dict[str, str]:
    """The sources of an evaluator that there is."""
    return written.sources(making.program(model, form, tested=tested), language)


def numpy_text(model: Model, form: Form) -> str:
    """The same as the text of one Python module."""
    (text,) = program_files(model, form, "numpy").values()
    return text


def assemble(form: Form) -> Program:
    """The program of an evaluator, with no word of what it was made from."""
    return form.program(None)
