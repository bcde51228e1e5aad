"""Which outputs are 0 whatever the parameters are: at free ends, and before the first wave comes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from hashlib import sha256

from flint import fmpq

from wavesym.exact.arrivals import identically_zero
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import Real
from wavesym.programs.runtime.request import RuntimeField


def drawn(fields: Sequence[RuntimeField]) -> Mapping[str, fmpq]:
    """A number for each parameter: what is 0 with them is 0 with all of them, but for a chance of one in 2**60."""
    return {label: _number(label) for field in fields for label in field.labels}


def quiet(model: Model, loads: Sequence[Applied], real: Real) -> list[bool]:
    """Whether each output of a model that has the numbers drawn is 0 up to the horizon, whatever `loads` amount to.

    Of each source the first is enough: others do the same later.
    """
    until = rational(model.horizon(real))
    first: dict[str, fmpq] = {}
    for change in (change for load in loads for change in load.changes if change.time <= until):
        first[change.source] = min(change.time, first.get(change.source, until))
    acting = (Applied(source, time, _number(source)) for source, time in first.items())
    return identically_zero(replace(model, loads=tuple(sorted(acting, key=lambda load: load.time))), until)


def _number(label: str) -> fmpq:
    return fmpq(int(sha256(label.encode()).hexdigest()[:16], 16) + 1, 1 << 62)
