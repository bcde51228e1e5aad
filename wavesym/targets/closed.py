"""The closed form as C and as NumPy: its pulses, families and coefficients as tables."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.closed import ClosedForm, Pulse
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.header import common_header
from wavesym.targets.literals import c_literal, firsts, lines, literal


@dataclass(frozen=True)
class Source:
    """templates/c/closed.c.j2; every table as the lines between its braces."""

    scene: Description
    first_pulse: tuple[str, ...]
    start: tuple[str, ...]
    excess: tuple[str, ...]
    first_family: tuple[str, ...]
    rate: tuple[str, ...]
    first_power: tuple[str, ...]
    coefficient: tuple[str, ...]
    exponential: str


@dataclass(frozen=True)
class Module:
    """templates/numpy/closed.py.j2: for every output its pulses, each a line."""

    scene: Description
    outputs: tuple[tuple[str, ...], ...]


def c_header(scene: Description, form: ClosedForm) -> str:
    """NAME.h."""
    return common_header(scene)


def c_source(scene: Description, form: ClosedForm) -> str:
    """NAME.c."""
    real = form.real
    pulses = [pulse for output in form.outputs for pulse in output.pulses]
    families = [family for pulse in pulses for family in pulse.families]
    source = Source(
        scene=scene,
        first_pulse=firsts(len(output.pulses) for output in form.outputs),
        start=_reals((pulse.start for pulse in pulses), real),
        excess=_reals((pulse.excess for pulse in pulses), real),
        first_family=firsts(len(pulse.families) for pulse in pulses),
        rate=_reals((family.rate for family in families), real),
        first_power=firsts(len(family.powers) for family in families),
        coefficient=_reals((power for family in families for power in family.powers), real),
        exponential="exp" if real is DOUBLE else "expf",
    )
    return render("c/closed.c.j2", source)


def numpy_source(scene: Description, form: ClosedForm) -> str:
    """NAME.py."""
    outputs = tuple(tuple(_python(pulse, form.real) for pulse in output.pulses) for output in form.outputs)
    return render("numpy/closed.py.j2", Module(scene, outputs))


def _reals(values: Iterable[float], real: Real) -> tuple[str, ...]:
    return lines(c_literal(value, real) for value in values)


def _python(pulse: Pulse, real: Real) -> str:
    families = (
        f"({literal(f.rate, real)}, {_tuple(literal(power, real) for power in f.powers)})" for f in pulse.families
    )
    return f"({literal(pulse.start, real)}, {literal(pulse.excess, real)}, {_tuple(families)})"


def _tuple(items: Iterable[str]) -> str:
    return "(" + "".join(f"{item}, " for item in items).rstrip() + ")"
