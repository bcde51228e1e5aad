"""System II: m shafts between m + 1 rigid discs under step moments; (4.4)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar, Literal

from pydantic import Field

from wavesym.fields.loads import LoadKinds, TimedLoad
from wavesym.fields.numbers import Integer, Numbers, Positives
from wavesym.fields.table import shown
from wavesym.model.loads import Applied
from wavesym.model.node import Family, Node, Parameters, Quantity, Rod, System, UnitLoad, single
from wavesym.numbers.doubles import rational
from wavesym.systems.preset import Preset


def _families(m: Quantity, p: Parameters) -> tuple[Family, ...]:
    def shaft(i: Quantity) -> Rod:
        return Rod(tau0=0, x0=i - 1)

    def moment(number: Quantity, sign: int = 1) -> tuple[UnitLoad, ...]:
        # the A_i of (4.4), in units of G J_01 theta_0 / l
        return (UnitLoad("M", number, (sign * p.kappa[1] * p.inertia[1] / p.inertia[number],)),)

    def pull(i: Quantity) -> Quantity:
        """What shaft i does to disc i + 1."""
        return 2 * p.kappa[i] * p.inertia[i] / p.inertia[i + 1]

    return (
        single(0, lambda: Node(None, shaft(1), inertia=1, alpha=0, beta=2 * p.kappa[1], loads=moment(1))),
        Family(
            1,
            m - 1,
            1,
            lambda i: Node(
                shaft(i), shaft(i + 1), inertia=1, alpha=pull(i), beta=2 * p.kappa[i + 1], loads=moment(i + 1)
            ),
        ),
        # the last moment counts against positive rotation, as in the paper
        single(m, lambda: Node(shaft(m), None, inertia=1, alpha=pull(m), beta=0, loads=moment(m + 1, sign=-1))),
    )


def _indices(m: int) -> Mapping[str, range]:
    return {"kappa": range(1, m + 1), "inertia": range(1, m + 2)}


DRIVE = System("drive", _families, _indices, smallest=1)


class Moment(TimedLoad):
    """(3.1): the moment on a body of a drive, sum_k steps_k H(tau - times_k)."""

    body: Integer = Field(description="the number of a body, 1 to m + 1")
    steps: Numbers = Field(description="a list with a number for each time")

    def refused(self, m: int) -> tuple[str, str] | None:
        """A body that there is not."""
        if 1 <= self.body <= m + 1:
            return None
        return f"{shown(self.body)} given, a body from 1 to {m + 1} expected", "body"

    def units(self) -> Iterator[Applied]:
        """The load as unit responses."""
        for time, step in zip(self.times, self.steps, strict=True):
            yield Applied(f"M{self.body}", rational(time), rational(step))


class Drive(Preset):
    """m shafts between m + 1 rigid discs at x = 0, 1, ... m."""

    variants: ClassVar[tuple[System, ...]] = (DRIVE,)
    counts: ClassVar[Mapping[str, str]] = {"kappa": "m", "inertia": "m + 1"}
    load_kinds: ClassVar[LoadKinds] = (Moment,)

    type: Literal["drive"] = Field(description='"drive"')
    kappa: Positives = Field(description="a list of m positive numbers")
    inertia: Positives = Field(description="a list of m + 1 positive numbers")
