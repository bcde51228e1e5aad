"""Python that imports nothing but NumPy: NAME.py, the tables that a scheme reads, and the scheme itself."""

from __future__ import annotations

import inspect
from collections.abc import Iterable

from wavesym.programs.program import Program
from wavesym.programs.schemes import PARTS, SCHEMES
from wavesym.programs.schemes.scheme import Scheme
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import lines, literal

HAS_SELFTEST = False

_WIDTH = 112


def files(scene: Description, program: Program) -> dict[str, str]:
    """The text of the module, by its name."""

    def literals(values: Iterable[float]) -> Iterable[str]:
        return (str(value) if isinstance(value, int) else literal(value, program.real) for value in values)

    scheme = SCHEMES[program.kernel]
    text = render(
        "numpy/program.py.j2",
        scene=scene,
        tables={name: lines(literals(program.tables[name]), _WIDTH) for name in scheme.TABLES},
        constants=dict(zip(scheme.CONSTANTS, literals(program.constants[n] for n in scheme.CONSTANTS), strict=True)),
        scheme="\n\n\n".join(map(_text, (Scheme, *PARTS.get(program.kernel, ()), scheme))),
        scheme_name=scheme.__name__,
    )
    return {f"{scene.name}.py": text}


def _text(part: type) -> str:
    """The file of a part of a scheme, from its first class on."""
    module = inspect.getmodule(part)
    assert module  # it was imported from one
    text = inspect.getsource(module)
    return text[text.index("\nclass ") :].strip()
