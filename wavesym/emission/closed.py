"""The closed form as C and as NumPy: its pulses, families and coefficients as tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate

from wavesym.emission.description import Description
from wavesym.emission.literals import lines, literal
from wavesym.emission.rendering import render
from wavesym.evaluators.closed import ClosedForm, Pulse


@dataclass(frozen=True)
class Header:
    """templates/c/header.h.j2."""

    scene: Description


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


@dataclass(frozen=True)
class SelfTest:
    """templates/c/selftest.c.j2: `values` by output, then by tau."""

    scene: Description
    count: str
    taus: tuple[str, ...]
    values: tuple[str, ...]
    allowed: tuple[str, ...]


@dataclass(frozen=True)
class Module:
    """templates/numpy/closed.py.j2: for every output its pulses, each a line."""

    scene: Description
    outputs: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Reference:
    """Values of all outputs at `taus`, right to the last bit, and how far each output may be from them."""

    taus: Sequence[float]
    values: Sequence[Sequence[float]]
    allowed: Sequence[float]


def c_files(scene: Description, form: ClosedForm, reference: Reference) -> dict[str, str]:
    """Header, source and self-test."""
    pulses = [pulse for output in form.outputs for pulse in output.pulses]
    families = [family for pulse in pulses for family in pulse.families]
    source = Source(
        scene=scene,
        first_pulse=_firsts(len(output.pulses) for output in form.outputs),
        start=_doubles(pulse.start for pulse in pulses),
        excess=_doubles(pulse.excess for pulse in pulses),
        first_family=_firsts(len(pulse.families) for pulse in pulses),
        rate=_doubles(family.rate for family in families),
        first_power=_firsts(len(family.powers) for family in families),
        coefficient=_doubles(power for family in families for power in family.powers),
    )
    selftest = SelfTest(
        scene=scene,
        count=str(len(reference.taus)),
        taus=_doubles(reference.taus),
        values=_doubles(value for row in reference.values for value in row),
        allowed=_doubles(reference.allowed),
    )
    return {
        f"{scene.name}.h": render("c/header.h.j2", Header(scene)),
        f"{scene.name}.c": render("c/closed.c.j2", source),
        f"{scene.name}_selftest.c": render("c/selftest.c.j2", selftest),
    }


def numpy_files(scene: Description, form: ClosedForm) -> dict[str, str]:
    """The NumPy module."""
    outputs = tuple(tuple(_python(pulse) for pulse in output.pulses) for output in form.outputs)
    return {f"{scene.name}.py": render("numpy/closed.py.j2", Module(scene, outputs))}


def _doubles(values: Iterable[float]) -> tuple[str, ...]:
    return lines(map(literal, values))


def _firsts(counts: Iterable[int]) -> tuple[str, ...]:
    """Where each group starts in a flat table, and where the last one ends."""
    return lines(map(str, accumulate(counts, initial=0)))


def _python(pulse: Pulse) -> str:
    families = (f"({literal(f.rate)}, {_tuple(literal(power) for power in f.powers)})" for f in pulse.families)
    return f"({literal(pulse.start)}, {literal(pulse.excess)}, {_tuple(families)})"


def _tuple(items: Iterable[str]) -> str:
    return "(" + "".join(f"{item}, " for item in items).rstrip() + ")"
