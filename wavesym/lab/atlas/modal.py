"""Families of curves: modes against their number, against damping, and against the spacing of a record's samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from wavesym.errors import ToleranceError, WavesymError
from wavesym.fields.numbers import decimal_text
from wavesym.lab.atlas.attempts import Truth, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import atlas_scene, with_tolerance
from wavesym.lab.standard import standard
from wavesym.mechanics.model import Model
from wavesym.methods.discrete import DiscreteModel
from wavesym.methods.elements import Elements
from wavesym.methods.network_problem import linear_problem
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import nearest, rational
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.hats import hat_march
from wavesym.programs.making import make, program
from wavesym.programs.march.evaluator import march
from wavesym.programs.modes.evaluator import ModesEvaluator, modes
from wavesym.programs.program import Program
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower

_RODS, _LEAP = 2, 8


def shaken_building(spacing: Fraction, samples: int, tolerance: Fraction, damping: Any = 0, **outputs: Any) -> Scene:
    """A building of two storeys on ground that shakes as so many samples say, which leap between -1 and 1.

    The first is 0 at tau = 0, the last is at the horizon; they may be any time apart.
    """
    leaps = [Fraction(0), *(Fraction((7 * k * k + 3 * k) % 17 - _LEAP, _LEAP) for k in range(1, samples))]
    system = {"type": "building", "m": _RODS, "kappa": ["1/10", "1/5", "1/10"], "base": "ground", "damping": damping}
    load = {"spacing": spacing, "samples": leaps}
    return with_tolerance(atlas_scene(system, [load], spacing * (samples - 1), **outputs), tolerance)


def by_modes(model: Model, taus: Array) -> tuple[ModesEvaluator, Array]:
    """As many modes as the model's tolerance takes, and all outputs (outputs, n). ToleranceError of too many."""
    form = modes(model, DOUBLE)
    return form, program(model, form).evaluate(taus)


def largest_error(values: Array, right: Array, sizes: Array) -> float:
    """The largest error of any output, relative to its largest value; of `right` values (outputs, n)."""
    return float(np.max(np.abs(values - right) / sizes[:, np.newaxis]))


# against the number of modes

SAMPLES = 9
SPACINGS = (Fraction(5, 2), Fraction("4.995"))
DIGITS = range(13)
OUTPUTS: dict[str, Any] = {"acceleration": [2], "force": [0], "drift": [1], "relative": [2]}


def mode_counts(
    progress: Progress, spacings: Sequence[Fraction] = SPACINGS, digits: Sequence[int] = DIGITS
) -> CurveFamily:
    """A curve for each kind of output: as many modes as each tolerance takes, up to the most that are taken."""
    points: list[AtlasPoint] = []
    for spacing in spacings:
        known = truth(shaken_building(spacing, SAMPLES, Fraction(1), **OUTPUTS), per_unit=4)
        for number in range(len(known.model.probes)):
            progress(f"modes, samples {float(spacing):g} apart, {known.model.probes[number].name}")
            points += _one_output(known, number, f"samples {float(spacing):g} apart", digits)
    return CurveFamily(
        "modes",
        "Error against the number of modes: forces and accelerations need many, motion few",
        Axis("modes"),
        "largest error / largest value",
        tuple(points),
        "from tables in balls; as many modes as a tolerance of 1, 1/10, 1/100, ... takes",
    )


def _one_output(known: Truth, number: int, panel: str, digits: Sequence[int]) -> Iterator[AtlasPoint]:
    """One output alone."""
    probe, counts = known.model.probes[number], set[int]()
    model = known.model.watching((probe,))
    for digit in digits:
        try:
            form, values = by_modes(model.tolerating(rational(Fraction(1, 10**digit))), known.taus)
        except ToleranceError:  # more modes than are taken
            return
        count = len(form.system.frequency)
        if count not in counts:
            error = largest_error(values, known.values[[number]], known.standard.sizes[[number]])
            yield AtlasPoint(panel, probe.name, count, error, form.error_bound)
        counts.add(count)


# against damping

_NEARLY = Fraction(1, 10**9)
RATIOS = (
    *(Fraction(number) for number in ("0", "1/1000", "1/100", "1/50", "1/20", "1/10", "1/5", "1/2")),
    *(1 - _NEARLY, Fraction(1), 1 + _NEARLY),
    *(Fraction(number) for number in ("11/10", "2", "5", "10")),
)
ALL, RAYLEIGH = "all modes at this ratio", "Rayleigh: modes 1 and 2 at this ratio"
PANELS = (ALL, RAYLEIGH)
MODES, ELEMENTS, DOUBT = "modes", "finite elements", "extrapolation itself"
SPACING = Fraction(5, 2)
TOLERANCE = Fraction(1, 10**6)

_CELLS = (8, 16, 32, 64)  # of a rod
_INSTANTS = 10  # of a step


class Extrapolation(NamedTuple):
    """Outputs at `taus` (outputs, n): of the finest elements, and of none; and these from elements twice as coarse."""

    taus: Array
    finest: Array
    limit: Array
    coarser: Array


def damping(progress: Progress, ratios: Sequence[Fraction] = RATIOS, panels: Sequence[str] = PANELS) -> CurveFamily:
    """Damping from none to far beyond critical: modes against finite elements that are extrapolated.

    Displacements, as their elements converge well enough to judge what modes leave out. The elements have consistent
    mass, and modes of their own, which are damped and stepped by other means. Their error has even powers of an element
    alone where nothing bends too sharply; two levels of extrapolation tell by how much it has.
    """
    points = []
    for panel in panels:
        for ratio in ratios:
            progress(f"damping, {panel}: {float(ratio):g}")
            model = lower(
                shaken_building(SPACING, SAMPLES, TOLERANCE, damping_of(panel, ratio), drift=[1], relative=[2])
            )
            found = extrapolate(model)
            sizes = np.max(np.abs(found.limit), axis=1)
            form, values = by_modes(model, found.taus)
            for name, one, bound in (
                (MODES, values, form.error_bound),
                (ELEMENTS, found.finest, np.inf),
                (DOUBT, found.coarser, np.inf),
            ):
                points.append(AtlasPoint(panel, name, float(ratio), largest_error(one, found.limit, sizes), bound))
    return CurveFamily(
        "damping",
        "Error of modes against damping, from none to ten times critical: no ratio is a special case",
        Axis("damping ratio", zero=1e-4),
        "largest difference / largest value",
        tuple(points),
        f"from finite elements, {_CELLS[-1]} a rod, extrapolated to none; that may itself be wrong by its own curve",
        least=1e-12,
        most=1e-4,
    )


def damping_of(panel: str, ratio: Fraction) -> Fraction | str | Mapping[str, Any]:
    """What a scene says of it; above critical damping in percent."""
    stated = ratio if ratio <= 1 else f"{decimal_text(100 * ratio)} %"
    return stated if panel == ALL else {"modes": [1, 2], "ratio": stated}


def extrapolate(model: Model) -> Extrapolation:
    """The limit of elements that are halved again and again, by two powers of their length."""
    problem = linear_problem(model)
    levels = []
    for count in _CELLS:
        cells = np.full(_RODS, count)
        taus, values = DiscreteModel(Elements(problem, cells)).outputs(float(SPACING) / _INSTANTS)
        levels.append(values)
    once = [(4 * fine - coarse) / 3 for coarse, fine in pairwise(levels)]
    coarser, limit = ((16 * fine - coarse) / 15 for coarse, fine in pairwise(once))
    return Extrapolation(taus, levels[-1], limit, coarser)


# against the spacing of a record

PARTS = (1, 2, 4, 8, 16, 32, 200, 10**3, 10**6, 10**9, 10**12)
RECORD_SAMPLES = 18  # two more than a march has panels


def spacing(parts: int) -> Fraction:
    """So many samples are a whole number of rods, and no fewer."""
    return 5 - Fraction(1, parts)


def spacings(progress: Progress, counts: Sequence[int] = PARTS) -> CurveFamily:
    """Each program at the samples."""
    points = []
    for parts in counts:
        scene = shaken_building(spacing(parts), RECORD_SAMPLES, TOLERANCE, force=[0], drift=[1], relative=[2])
        known = standard(model := lower(scene))
        times = (nearest(rational(k * spacing(parts))) for k in range(RECORD_SAMPLES))
        taus = np.array([min(time, known.until) for time in times])
        right = np.array(known.values(taus.tolist()))
        for name, form in _PROGRAMS.items():
            progress(f"samples 5 - 1/{parts} apart, {name}")
            try:
                found = form(model)
                values = found.evaluate(taus)
            except WavesymError as why:
                points.append(AtlasPoint("", name, parts, float("nan"), refusal=str(why)))
                continue
            error = float(np.max(known.errors(values, right)))
            refused = f"{name}: a bound of {found.error_bound:.1e} in all" if found.error_bound > TOLERANCE else ""
            points.append(AtlasPoint("", name, parts, error, found.error_bound, refused))
    return CurveFamily(
        "spacings",
        "Samples 5 - 1/q apart: a march goes to q = 16, that of one hat far on, modes anywhere",
        Axis("q"),
        "largest error at the samples / largest value",
        tuple(points),
        "filled: proved to stay below 1e-6; hollow: not; cross: refused before the work (the table has each reason)",
    )


def _modes(model: Model) -> Program:
    return make(model, Request(evaluator="modes"))


def _march(model: Model) -> Program:
    """As it is, and not of one hat."""
    return program(model, march(model))


def _hat(model: Model) -> Program:
    form = hat_march(model)
    assert form  # there are samples enough
    return program(model, form)


_PROGRAMS: Mapping[str, Callable[[Model], Program]] = {"modes": _modes, "march": _march, "march of one hat": _hat}
