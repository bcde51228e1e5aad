"""Uncomfortable scenes drawn by Hypothesis, and any scene as TOML.

Horizons end at a front, or hardly after one; loads, places and bodies nearly coincide; sizes are far apart.
"""

from __future__ import annotations

import json
from fractions import Fraction

import numpy as np
from hypothesis import strategies as st

from wavesym.fields.loads import SampledLoad
from wavesym.scene import Scene, builtin_names
from wavesym.systems.building import Acceleration, Building
from wavesym.systems.collision import Collision
from wavesym.systems.drive import Moment

NAMED = [name for name in builtin_names() if Scene.from_toml(name).system.type != "chain"]
"""The built-in scenes of the paper's systems, which have tables, derivation and every program."""

BESIDE = [Fraction(1, 10**6), Fraction(1, 10**9), Fraction(1, 10**12)]
"""What separates the nearly equal."""

_KAPPAS = [Fraction(k) for k in ("1/2", "1", "11/10", "3/5", "1/4", "7/3", "1/50", "20", "1/1000")]
_PARTS = [Fraction(x) for x in ("0", "1/2", "1/3", "7/10", "4/5")]
_TIMES = [Fraction(t) for t in ("0", "0", "1/3", "1/2", "7/10", "1", "4/3", "5/2", "3.2")]
_HORIZONS = [Fraction(t) for t in ("3.2", "1.7", "2.1", "9.1", "3", "13/3", "7.3", "1e-12", "1e-200", "1/8")]
_LONG = [Fraction(t) for t in ("20", "31.7", "41.3", "60")]


def _near(number: Fraction) -> st.SearchStrategy[Fraction]:
    """A number, and others that are hardly less or more."""
    return st.sampled_from([number, number, *(number + sign * by for by in BESIDE for sign in (-1, 1))])


@st.composite
def _ratios(draw, count):
    """So many ratios of masses: one, and others that equal it, are nearly equal, or any."""
    one = draw(st.sampled_from(_KAPPAS))
    like_one = st.sampled_from([one, one, one / 2, *(one * (1 + by) for by in BESIDE)])
    return [one, *draw(st.lists(st.one_of(like_one, st.sampled_from(_KAPPAS)), min_size=count - 1, max_size=count - 1))]


@st.composite
def systems(draw, precision, largest=5):
    """The table `system` of a scene."""
    kind = draw(st.sampled_from(["collision", "drive", "building"]))
    if kind == "collision":
        m = draw(st.sampled_from([4, 6]))
        slower = draw(st.lists(st.sampled_from([1, "3/8", 0, -1, "1e-9"]), min_size=m // 2 - 1, max_size=m // 2 - 1))
        size = draw(sizes(precision))
        velocity = [abs(size) * v for v in (1, *sorted(map(Fraction, slower), reverse=True))]
        return {"type": kind, "m": m, "kappa": draw(_ratios(m // 2)), "velocity": velocity}
    m = draw(st.integers(1 if kind == "drive" else 2, largest))
    if kind == "drive":
        return {"type": kind, "m": m, "kappa": draw(_ratios(m)), "inertia": draw(_ratios(m + 1))}
    base = draw(st.sampled_from(["force", "ground"]))
    return {"type": kind, "m": m, "kappa": draw(_ratios(m + 1)), "base": base}


def sizes(precision) -> st.SearchStrategy[Fraction]:
    """Factors of loads, mostly moderate; decimals, since no other number this small can be written in a scene."""
    extremes = [-290, -200, -12, 12, 200, 290] if precision == "double" else [-44, -30, -12, 12, 30, 200]
    exponents = st.sampled_from([0] * len(extremes) + extremes)
    return st.builds(lambda x, e: Fraction(x) * Fraction(10) ** e, st.sampled_from([1, -1, 2, "-3/8"]), exponents)


@st.composite
def loads(draw, system, precision):
    """The tables `load` of a scene; times nearly coincide with each other or differ by nearly whole units."""
    if system["type"] == "collision":
        return []
    if system["type"] == "building" and draw(st.integers(0, 7)) == 0:
        samples = draw(st.lists(st.sampled_from([0, "1/10", "-3/10", 1]), min_size=2, max_size=5))
        return [{"spacing": draw(st.sampled_from(["1/5", "0.02", "3/7", "1.1"])), "samples": samples}]
    times = {draw(st.sampled_from(_TIMES))}
    for _ in range(draw(st.integers(0, 2))):
        after = draw(_near(draw(st.sampled_from(sorted(times))) + draw(st.sampled_from([*_PARTS, Fraction(1)]))))
        times.add(max(after, Fraction(0)))
    times = sorted(times)
    # one size, or a size for each time
    common = draw(st.one_of(st.just(None), sizes(precision)))
    weights = [draw(sizes(precision)) if common is None else common for _ in times]
    if system["type"] == "drive":
        return [{"body": draw(st.integers(1, system["m"] + 1)), "times": times, "steps": weights}]
    kind = draw(st.sampled_from(["a", "b", "both"]))
    none = [0] * len(times)
    return [{"times": times, "a": none if kind == "b" else weights, "b": none if kind == "a" else weights}]


@st.composite
def places(draw, system, quantity):
    """A place: a node, an end, hardly beside a node, or in a rod; with a side where a strain needs one."""
    m = system["m"]
    x = draw(st.integers(0, m)) + draw(st.sampled_from([Fraction(0), *_PARTS]))
    x = min(max(draw(_near(x)), Fraction(0)), Fraction(m))
    divided = 0 < x < m and x.denominator == 1 and (system["type"] != "collision" or x % 2 == 1)
    return f"{x}{draw(st.sampled_from('-+'))}" if quantity == "strain" and divided else str(x)


def _sources(system, load) -> list[tuple[Fraction, Fraction]]:
    """Where and when fronts start."""
    if system["type"] == "collision":
        return [(Fraction(x), Fraction(0)) for x in range(2, system["m"], 2)]
    x = Fraction(load[0].get("body", 1) - 1)
    return [(x, Fraction(time)) for time in load[0].get("times", [0, load[0].get("spacing")])]


def _just_after(tau: Fraction, real: type) -> Fraction:
    """The first number of a floating-point format after tau."""
    number = real(float(tau))
    while Fraction(float(number)) <= tau:
        number = np.nextafter(number, real(np.inf))
    return Fraction(float(number))


@st.composite
def _horizons(draw, system, load, watched, longest):
    """The end of the horizon: most often at a front in one of the places watched, or hardly before or after it."""
    kind = draw(st.sampled_from(["front"] * 7 + ["fixed"] * 3 + ["long"] * longest))
    if kind == "fixed":
        return draw(st.sampled_from(_HORIZONS))
    if kind == "long":
        return draw(st.sampled_from(_LONG))
    x, start = draw(st.sampled_from(_sources(system, load)))
    place = Fraction(draw(st.sampled_from(watched)).rstrip("+-"))
    # directly, or after reflections from the next nodes
    distance = draw(st.sampled_from([abs(place - x), place % 1, -place % 1]))
    front = start + distance + draw(st.sampled_from([0, 0, 1, 2, 3, 5]))
    k = draw(st.integers(1, 40))
    if front == 0:
        return Fraction(1, 2**k)
    late = [
        front,
        _just_after(front, np.float64),
        _just_after(front, np.float32),
        front + Fraction(1, 2**k),
        front - Fraction(1, 2**k),
        front + draw(st.sampled_from(BESIDE)),
        Fraction(repr(float(np.nextafter(np.float32(front), np.float32(0))))),
    ]
    until = draw(st.sampled_from(late))
    return until if until > 0 else Fraction(1, 2**k)


@st.composite
def scenes(draw, precision="double", longest=True):
    """A scene with a tolerance that a precision can often meet; without `longest`, no horizon above 15."""
    system = draw(systems(precision))
    load = draw(loads(system, precision))
    output: dict[str, object] = {}
    for quantity in sorted(draw(st.sets(st.sampled_from(["strain", "velocity", "displacement"]), min_size=1))):
        several = st.lists(
            places(system, quantity), min_size=1, max_size=2, unique_by=lambda x: Fraction(x.rstrip("+-"))
        )
        output[quantity] = draw(several)
    watched = sorted(place for several in output.values() for place in several)
    output["until"] = draw(_horizons(system, load, watched, longest))
    output["tolerance"] = Fraction(10) ** -draw(st.integers(2, 13 if precision == "double" else 5))
    return Scene(name="drawn", system=system, load=load, output=output)


def as_toml(scene: Scene) -> str:
    """The scene file of a scene: what reads back to the same scene."""
    system = scene.system
    lines = [f'name = "{scene.name}"', "", "[system]", f'type = "{system.type}"', f"m = {system.m}"]
    lines.append(f"kappa = {_numbers(system.kappa)}")
    if isinstance(system, Building):
        lines.append(f'base = "{system.base}"')
    else:
        name, values = ("velocity", system.velocity) if isinstance(system, Collision) else ("inertia", system.inertia)
        lines.append(f"{name} = {_numbers(values)}")
    for load in scene.load:
        lines += ["", "[[load]]"]
        match load:
            case Moment():
                lines += [f"body = {load.body}", f"times = {_numbers(load.times)}", f"steps = {_numbers(load.steps)}"]
            case Acceleration():
                lines += [f"{key} = {_numbers(getattr(load, key))}" for key in ("times", "a", "b")]
            case SampledLoad():
                lines += [f"spacing = {_number(load.spacing)}", f"samples = {_numbers(load.samples)}"]
    output = scene.output
    lines += ["", "[output]", f"until = {_number(output.until)}", f"tolerance = {_number(output.tolerance)}"]
    for quantity in ("strain", "velocity", "displacement"):
        if watched := getattr(output, quantity):
            lines.append(f"{quantity} = {json.dumps([place.text for place in watched])}")
    return "\n".join(lines) + "\n"


def _numbers(values) -> str:
    return f"[{', '.join(map(_number, values))}]"


def _number(value: Fraction) -> str:
    """An integer, or the shorter of a ratio and a decimal."""
    if value.denominator == 1 and abs(value) < 2**63:
        return str(value.numerator)
    texts = [f'"{value}"']
    if 10**1000 % value.denominator == 0:
        texts.append(_decimal(value))
    return min(texts, key=len)


def _decimal(value: Fraction) -> str:
    """The decimal of a number that has one."""
    exponent = 0
    while value.denominator > 1:
        value, exponent = value * 10, exponent - 1
    first, *others = str(abs(value.numerator))
    digits = f"{'-' * (value < 0)}{first}.{''.join(others).rstrip('0') or 0}"
    return f"{digits}e{exponent}" if (exponent := exponent + len(others)) else digits
