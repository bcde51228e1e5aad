"""Python that imports nothing but NumPy: NAME.py, the tables that a scheme reads, and the scheme itself."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Sequence
from textwrap import wrap

from wavesym.programs.program import Program
from wavesym.programs.schemes import PARTS, SCHEMES, names_read
from wavesym.programs.schemes.scheme import Scheme
from wavesym.rendering import render
from wavesym.targets.c.tables import declarations
from wavesym.targets.description import Description
from wavesym.targets.literals import lines, literal

HAS_SELFTEST = False

_WIDTH = 112
_HEADERS = {"hats": "march"}
"""Kernels whose tables another one declares."""


def files(scene: Description, program: Program) -> dict[str, str]:
    """The text of the module, by its name."""

    def literals(values: Iterable[float]) -> Iterable[str]:
        return (str(value) if isinstance(value, int) else literal(value, program.real) for value in values)

    scheme = SCHEMES[program.kernel]
    names, numbers = names_read(scheme, program.tables, program.constants, program.tau_max)
    called = {name: name.rpartition(".")[2] for name in names}  # in its march, where a program is of several
    comments = _comments(program.kernel, [*called.values()])
    text = render(
        "numpy/program.py.j2",
        scene=scene,
        tables={
            name: (comments.pop(own, ()), lines(literals(program.tables[name]), _WIDTH)) for name, own in called.items()
        },
        constants=dict(zip(numbers, literals(program.constants[name] for name in numbers), strict=True)),
        scheme="\n\n\n".join(map(_text, (Scheme, *PARTS.get(program.kernel, ()), scheme))),
        scheme_name=scheme.__name__,
    )
    return {f"{scene.name}.py": text}


def _comments(kernel: str, names: Sequence[str]) -> dict[str, list[str]]:
    """What is said of tables where C declares them, with the first that a comment is of."""
    found, comment = dict[str, list[str]](), ""
    for item in (item for paragraph in declarations(f"{_HEADERS.get(kernel, kernel)}/tables.h") for item in paragraph):
        if item["comment"] or item["enum"]:
            comment = " ".join(line.strip("/* ") for line in (item["comment"] or "").splitlines())
        elif item["name"] in names:
            found[item["name"]], comment = wrap(comment, _WIDTH), ""
    return found


def _text(part: type) -> str:
    """The file of a part of a scheme, from its first class on."""
    module = inspect.getmodule(part)
    assert module  # it was imported from one
    text = inspect.getsource(module)
    return text[text.index("\nclass ") :].strip()
