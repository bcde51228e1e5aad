"""The closed form as NumPy: for every output its pulses."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from wavesym.numbers.reals import Real
from wavesym.programs.closed import ClosedForm, Pulse
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import literal


@dataclass(frozen=True)
class NumPyClosed:
    """templates/numpy/closed.py.j2: for every output its pulses, each a line."""

    scene: Description
    outputs: tuple[tuple[str, ...], ...]


def source(scene: Description, form: ClosedForm) -> str:
    """NAME.py."""
    outputs = tuple(tuple(_python(pulse, form.real) for pulse in output.pulses) for output in form.outputs)
    return render("numpy/closed.py.j2", NumPyClosed(scene, outputs))


def _python(pulse: Pulse, real: Real) -> str:
    families = (
        f"({literal(f.rate, real)}, {_tuple(literal(power, real) for power in f.powers)})" for f in pulse.families
    )
    return f"({literal(pulse.start, real)}, {literal(pulse.excess, real)}, {_tuple(families)})"


def _tuple(items: Iterable[str]) -> str:
    return "(" + "".join(f"{item}, " for item in items).rstrip() + ")"
