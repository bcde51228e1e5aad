"""Error against the number of modes, and what is proved of it: strains need many, motion a few."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from wavesym.errors import ToleranceError
from wavesym.lab.atlas import shaken
from wavesym.lab.atlas.attempts import Truth, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.numbers.doubles import rational

SAMPLES = 9
SPACINGS = (Fraction(5, 2), Fraction("4.995"))
DIGITS = range(13)
OUTPUTS: dict[str, Any] = {"acceleration": [2], "force": [0], "drift": [1], "relative": [2]}


def family(progress: Progress, spacings: Sequence[Fraction] = SPACINGS, digits: Sequence[int] = DIGITS) -> CurveFamily:
    """A curve for each kind of output: as many modes as each tolerance takes, up to the most that are taken."""
    points: list[AtlasPoint] = []
    for spacing in spacings:
        known = truth(shaken.scene(spacing, SAMPLES, Fraction(1), **OUTPUTS), per_unit=4)
        for number in range(len(known.model.probes)):
            progress(f"modes, samples {float(spacing):g} apart, {known.model.probes[number].name}")
            points += _points(known, number, f"samples {float(spacing):g} apart", digits)
    return CurveFamily(
        "modes",
        "Error against the number of modes: forces and accelerations need many, motion few",
        Axis("modes"),
        "largest error / largest value",
        tuple(points),
        "from tables in balls; as many modes as a tolerance of 1, 1/10, 1/100, ... takes",
    )


def _points(known: Truth, number: int, panel: str, digits: Sequence[int]) -> Iterator[AtlasPoint]:
    """One output watched alone."""
    probe, counts = known.model.probes[number], set[int]()
    model = known.model.watching((probe,))
    for digit in digits:
        try:
            form, values = shaken.of_modes(model.tolerating(rational(Fraction(1, 10**digit))), known.taus)
        except ToleranceError:  # more modes than are taken
            return
        count = len(form.system.frequency)
        if count not in counts:
            error = shaken.worst(values, known.values[[number]], known.sizes[[number]])
            yield AtlasPoint(panel, probe.name, count, error, form.error_bound)
        counts.add(count)
