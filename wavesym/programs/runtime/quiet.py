"""Which outputs are 0 whatever the parameters are: at free ends, and before the first wave comes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from hashlib import sha256

from flint import fmpq

from wavesym.exact.silence import silent
from wavesym.mechanics.loads import Applied
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import Real
from wavesym.programs.runtime.request import RuntimeField


def drawn(fields: Sequence[RuntimeField]) -> Mapping[str, fmpq]:
    """A number for each parameter: what is 0 with them is 0 with all of them, but for a chance of one in 2**60."""
    labels = [label for field in fields for label in field.labels]
    return {label: fmpq(int(sha256(label.encode()).hexdigest()[:16], 16) + 1, 1 << 62) for label in labels}


def quiet(model: Model, fields: Sequence[RuntimeField], loads: Sequence[Applied], real: Real) -> list[bool]:
    """Whether each output of a model that has the numbers drawn is 0 up to the horizon, `loads` acting on it: their
    amplitudes are their own, or parameters.
    """
    numbers = drawn(fields)
    weights = [numbers[label] for field in fields if field.name == "load" for label in field.labels]
    weights = weights or [load.weight for load in loads]
    acting = [replace(load, weight=weight) for load, weight in zip(loads, weights, strict=True)]
    ordered = tuple(sorted((load for load in acting if load.weight != 0), key=lambda load: load.time))
    return silent(replace(model, loads=ordered), rational(model.horizon(real)))
