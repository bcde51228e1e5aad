"""Families of curves: errors of closed form, pieces and march against what makes a scene hard for them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

import numpy as np

from wavesym.exact.breakpoints import Breakpoints
from wavesym.lab.atlas.attempts import EVALUATORS, attempt, skipped_attempt, truth
from wavesym.lab.atlas.family import AtlasPoint, Axis, CurveFamily, Progress
from wavesym.lab.atlas.scenes import AIM, LEGEND, atlas_scene, chain, drive, with_tolerance
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import common_measure, nearest, rational
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower

_ERROR = "largest error / largest value"


def _errors(
    progress: Progress,
    panel: str,
    places: Iterable[tuple[float, Scene]],
    per_unit: int,
    names: Sequence[str] = EVALUATORS,
) -> Iterator[AtlasPoint]:
    """The largest error of each evaluator at each place of an axis; truth at `per_unit` taus in a unit."""
    for x, scene in places:
        progress(f"{panel} {x:g}")
        known = truth(scene, per_unit)
        for name in names:
            yield attempt(known, name).point(panel, name, x)


# reflections

KAPPAS = (Fraction(1, 20), Fraction(1, 2), Fraction(5))
COUNTS = (1, 2, 3, 5, 7, 10, 14, 20, 30, 40, 50, 70, 100, 140, 200)
# pieces on longer horizons exist, but take minutes to fit
_FITTED = {Fraction(1, 20): 200, Fraction(1, 2): 100, Fraction(5): 50}


def reflections(progress: Progress, kappas: Sequence[Fraction] = KAPPAS, counts: Sequence[int] = COUNTS) -> CurveFamily:
    """One drive of two equal discs for each kappa; its first front meets each disc once in two units of tau."""
    points: list[AtlasPoint] = []
    for kappa in kappas:
        for name in EVALUATORS:
            progress(f"reflections, kappa = {kappa}, {name}")
            points += _reflection_points(kappa, name, counts)
    return CurveFamily(
        "reflections",
        "Error against reflections: the closed form loses all its digits, pieces and march stay within their bounds",
        Axis("reflections n of the first front at either disc, tau up to 2 n"),
        "largest error so far / largest value",
        tuple(points),
        LEGEND,
    )


def _reflection_points(kappa: Fraction, name: str, counts: Sequence[int]) -> Iterator[AtlasPoint]:
    """An evaluator for the longest horizon, looked at up to shorter ones."""
    until = 2 * (min(_FITTED[kappa], counts[-1]) if name == "pieces" else counts[-1])
    known = truth(drive([kappa], [1, 1], until), per_unit=3)
    one = attempt(known, name)
    assert one.errors is not None  # all of them have values here
    for count in (count for count in counts if 2 * count <= until):
        last = int(np.searchsorted(known.taus, 2 * count)) - 1
        error, bound = float(np.max(one.errors[: last + 1])), float(one.bounds[last])
        refused = one.refusal if bound > nearest(known.model.tolerance) else ""
        yield AtlasPoint(f"kappa = {kappa}", name, count, error, bound, refused)


# gaps between rates

GAPS = (*(Fraction(1, 10**k) for k in range(17)), Fraction(0))
REFLECTIONS = (5, 10)


def gaps(progress: Progress, gaps: Sequence[Fraction] = GAPS, counts: Sequence[int] = REFLECTIONS) -> CurveFamily:
    """Two and three rates that meet, after so many reflections.

    Partial fractions carry powers of 1/gap, which doubles cannot cancel. At a gap of exactly 0 the rates merge into one
    family, and the closed form is well again.
    """
    points: list[AtlasPoint] = []
    for rates, scene in (("2 rates", _two_rates), ("3 rates", _three_rates)):
        for count in counts:
            places = ((float(gap), scene(gap, 2 * count)) for gap in gaps)
            points += _errors(progress, f"{rates}, {count} reflections", places, per_unit=4)
    return CurveFamily(
        "gaps",
        "Error against the gap of rates: the closed form fails where rates nearly meet, not where they do",
        Axis("gap between neighbouring rates, of which the smallest is 1", zero=1e-18, falling=True),
        _ERROR,
        tuple(points),
        LEGEND,
        most=1e3,
    )


def _two_rates(gap: Fraction, until: int) -> Scene:
    """Rates 1 and 1 + gap."""
    return drive([Fraction(1)], [1 + gap, 1], until)


def _three_rates(gap: Fraction, until: int) -> Scene:
    """Rates 1, 1 + gap and 1 + 2 gap: of the middle disc half from either shaft, and gap more from the second."""
    return drive([Fraction(1), Fraction(1, 2) + gap], [1, 2, 1], until)


# extreme kappa

# at 1e4 the march may take a minute, as degrees up to the largest are tried before it refuses
EXPONENTS = (*range(-6, 4), 5, 6)
# the power series that pieces come from have more terms than kappa: minutes for 100, and then hours
_PIECES_TO, _WHY = 10, "a fit to so light a body takes minutes"
_COUNT = 5


def kappa(progress: Progress, exponents: Sequence[int] = EXPONENTS) -> CurveFamily:
    """Two equal discs and their shaft, kappa from 1e-6 to 1e6: very heavy and very light bodies."""
    panel, points = f"drive, m = 1, {_COUNT} reflections", list[AtlasPoint]()
    for exponent in exponents:
        kappa = Fraction(10) ** exponent
        progress(f"kappa = 1e{exponent}")
        known = truth(drive([kappa], [1, 1], 2 * _COUNT), per_unit=8)
        for name in EVALUATORS:
            tried = name != "pieces" or kappa <= _PIECES_TO
            one = attempt(known, name) if tried else skipped_attempt(known, name, _WHY)
            points.append(one.point(panel, name, float(kappa)))
    return CurveFamily(
        "kappa",
        "Error against kappa: heavy bodies cost the closed form digits, light ones cost the others degrees",
        Axis("kappa, impedance of the shaft against inertia of the disc"),
        _ERROR,
        tuple(points),
        LEGEND,
    )


# springs

STIFFNESSES = range(-6, 7)


def sprung_masses(stiffness: Fraction) -> Scene:
    """Two unit masses with a spring between them, the first pushed, the second on a rod that ends in a wall."""
    parts = [{"mass": 1, "name": "first"}, {"spring": stiffness}, {"mass": 1, "name": "second"}, {"rod": 1}, "fixed"]
    return chain(parts, 3, velocity=["first", "second"], strain=["0.5"])


def stiffness(progress: Progress, exponents: Sequence[int] = STIFFNESSES) -> CurveFamily:
    """K/M from 1e-6 to 1e6, for which the spring swings up to 700 times on the horizon."""
    places = ((10.0**exponent, sprung_masses(Fraction(10) ** exponent)) for exponent in exponents)
    return CurveFamily(
        "stiffness",
        "Error against the stiffness of a spring between two masses: bounds hold from soft to stiff",
        Axis("K/M, stiffness of the spring against either mass"),
        _ERROR,
        tuple(_errors(progress, "", places, per_unit=64)),
        LEGEND,
    )


# dashpots

DASHPOT_GAPS = (*(Fraction(1, 10**k) for k in range(0, 19, 2)), Fraction(0))
_SIDES = {"b = Z (1 + gap)": 1, "b = Z (1 - gap)": -1}
# when a pulse that is 1/4 long, seen in the middle of the bar, has been to the dashpot once, and twice
_ECHOES = {"first echo": 1.625, "second echo": 3.625}


def with_dashpot(dashpot: Fraction) -> Scene:
    """A bar of impedance 1, free but for a pulse of force at one end, with a dashpot at the other."""
    parts = [{"joint": True, "name": "first"}, {"rod": 1}, {"joint": True, "dashpot": dashpot}]
    pulse = {"at": "first", "times": [0, Fraction(1, 4)], "steps": [1, -1]}
    return atlas_scene({"type": "chain", "parts": parts}, [pulse], 8, strain=["1/2"])


def echoes(dashpot: Fraction) -> list[float]:
    """The size of each echo, by the pieces that would be generated; the pulse has size 1."""
    pieces = make(lower(with_tolerance(with_dashpot(dashpot), AIM)), Request(evaluator="pieces"))
    return list(map(float, np.abs(pieces.evaluate(list(_ECHOES.values()))[0])))


def dashpots(progress: Progress, gaps: Sequence[Fraction] = DASHPOT_GAPS) -> CurveFamily:
    """The errors of the evaluators, and how large the echoes are.

    A pulse runs along a bar to a dashpot b, which sends (b - Z)/(b + Z) of its stress back, and nothing if b = Z.
    """
    points: list[AtlasPoint] = []
    for panel, sign in _SIDES.items():
        places = ((float(gap), with_dashpot(1 + sign * gap)) for gap in gaps)
        points += _errors(progress, panel, places, per_unit=8)
        for gap in gaps:
            sizes = zip(_ECHOES, echoes(1 + sign * gap), strict=True)
            points += [AtlasPoint(panel, name, float(gap), size) for name, size in sizes]
    return CurveFamily(
        "dashpots",
        "Dashpots near the impedance: echoes shrink as the gap and as its square, and are exactly 0 where it is",
        Axis("gap", zero=1e-20, falling=True),
        "largest error, or echo, / largest value",
        tuple(points),
        LEGEND,
        least=1e-40,
        most=1e4,
    )


# lengths

LENGTH_GAPS = (*(Fraction(1, 10**k) for k in (0, 1, 2, 3, 6, 9, 12, 15, 18)), Fraction(0))
LENGTHS_UNTIL = 20


def nearly_equal(gap: Fraction) -> Scene:
    """Rods of length 1 and 1 + gap between three equal masses, of which the first is pushed."""
    parts = [{"mass": 1, "name": "first"}, {"rod": 1}, {"mass": 1}, {"rod": 1 + gap}, {"mass": 1}]
    return chain(parts, LENGTHS_UNTIL, velocity=["first"], strain=["1-"])


def lengths(progress: Progress, gaps: Sequence[Fraction] = LENGTH_GAPS) -> CurveFamily:
    """Breakpoints, steps, and the error of pieces, as the lengths come together."""
    models = {float(gap): lower(nearly_equal(gap)) for gap in gaps}
    breakpoints = [
        AtlasPoint("", "breakpoints, the most at one joint", x, most_breakpoints(model)) for x, model in models.items()
    ]
    steps = [
        AtlasPoint("", "steps of the common measure to the horizon", x, common_steps(m)) for x, m in models.items()
    ]
    places = ((float(gap), nearly_equal(gap)) for gap in gaps)
    return CurveFamily(
        "lengths",
        "Rods of lengths 1 and 1 + gap: a common grid would need ever more steps; breakpoints and errors stay",
        Axis("gap", zero=1e-20, falling=True),
        "a number; of pieces largest error / largest value",
        (*breakpoints, *steps, *_errors(progress, "", places, per_unit=4, names=["pieces"])),
        least=1e-17,
        most=1e21,
    )


def most_breakpoints(model: Model) -> int:
    """How many breakpoints the joint with most of them has by the horizon."""
    joints = Breakpoints(model, rational(model.horizon())).joints
    return max(sum(time <= model.until for time in times) for times in joints.values())


def common_steps(model: Model) -> float:
    """How many steps a grid has on which every wave takes a whole number of them through every rod."""
    return float(model.until / common_measure(bar.delay for bar in model.network.bars))
