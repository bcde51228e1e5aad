"""The closed form as C: its pulses, families and coefficients as tables."""

from __future__ import annotations

from dataclasses import dataclass

from wavesym.programs.closed import ClosedForm
from wavesym.rendering import render
from wavesym.targets.description import Description
from wavesym.targets.literals import c_literals, firsts
from wavesym.targets.number_format import number_format


@dataclass(frozen=True)
class CClosed:
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


def source(scene: Description, form: ClosedForm) -> str:
    """NAME.c."""
    real = form.real
    pulses = [pulse for output in form.outputs for pulse in output.pulses]
    families = [family for pulse in pulses for family in pulse.families]
    context = CClosed(
        scene=scene,
        first_pulse=firsts(len(output.pulses) for output in form.outputs),
        start=c_literals((pulse.start for pulse in pulses), real),
        excess=c_literals((pulse.excess for pulse in pulses), real),
        first_family=firsts(len(pulse.families) for pulse in pulses),
        rate=c_literals((family.rate for family in families), real),
        first_power=firsts(len(family.powers) for family in families),
        coefficient=c_literals((power for family in families for power in family.powers), real),
        exponential=number_format(real).c_exponential,
    )
    return render("c/closed.c.j2", context)
