"""Scenes drawn by Hypothesis: small systems of all kinds, equal and nearly equal parameters always among them."""

from fractions import Fraction

from hypothesis import strategies as st

import wavesym

NEARLY = Fraction(1000001, 10**6)

_fractions = st.fractions(min_value=Fraction(1, 12), max_value=3, max_denominator=12)
_kappas = st.one_of(st.sampled_from([Fraction(1, 2), Fraction(1), Fraction(11, 10)]), _fractions)
_times = st.sampled_from([Fraction(t) for t in ("0", "1/3", "1/2", "7/10", "1", "4/3", "5/2")])
_weights = st.sampled_from([Fraction(w) for w in (1, -1, 2, "-1/3")])


@st.composite
def ratios(draw, count):
    """So many ratios of masses: one, others that equal it, are nearly equal or a half of it, and any."""
    one = draw(_kappas)
    like_one = st.sampled_from([one, one, one * NEARLY, one / 2])
    return [one, *draw(st.lists(st.one_of(like_one, _kappas), min_size=count - 1, max_size=count - 1))]


@st.composite
def systems(draw, kinds=("collision", "drive", "building"), largest=4):
    """The table `system` of a scene; a collision has 4 or 6 rods, and often equal or nearly equal bodies."""
    kind = draw(st.sampled_from(kinds))
    if kind == "collision":
        m = draw(st.sampled_from([4, 6]))
        slower = draw(st.lists(st.sampled_from([0, "1/3", -1]), min_size=m // 2 - 1, max_size=m // 2 - 1))
        velocity = [Fraction(1), *sorted(map(Fraction, slower), reverse=True)]
        return {"type": kind, "m": m, "kappa": draw(ratios(m // 2)), "velocity": velocity}
    if kind == "drive":
        m = draw(st.integers(1, largest))
        return {"type": kind, "m": m, "kappa": draw(ratios(m)), "inertia": draw(ratios(m + 1))}
    m = draw(st.integers(2, largest))
    base = draw(st.sampled_from(["force", "ground"]))
    return {"type": kind, "m": m, "kappa": draw(ratios(m + 1)), "base": base}


@st.composite
def loads(draw, system):
    """One table `load` for a system that has loads, at times on and off integers; none for a collision."""
    if system["type"] == "collision":
        return []
    times = sorted(draw(st.lists(_times, min_size=1, max_size=3, unique=True)))

    def numbers(values):
        return draw(st.lists(values, min_size=len(times), max_size=len(times)))

    if system["type"] == "drive":
        moment = {"body": draw(st.integers(1, system["m"] + 1)), "times": times, "steps": numbers(_weights)}
        return [moment | draw(st.sampled_from([{}, {"ramps": numbers(_weights)}]))]
    return [{"times": times, "a": numbers(_weights), "b": numbers(st.one_of(st.just(Fraction(0)), _weights))}]


@st.composite
def outputs(draw, system, tolerance="1e-10"):
    """A strain, a velocity and a displacement, on and off the nodes."""
    place = st.fractions(min_value=0, max_value=system["m"], max_denominator=6)
    return {
        "until": draw(st.sampled_from([3, "13/3", 7])),
        "tolerance": tolerance,
        "strain": [draw(place.filter(lambda x: x.denominator > 1))],
        "velocity": [draw(place)],
        "displacement": [draw(place)],
    }


@st.composite
def scenes(draw, tolerance="1e-10"):
    """A scene: a system of up to three storeys or shafts, its loads, and what is watched."""
    system = draw(systems(largest=3))
    load = draw(loads(system))
    return wavesym.Scene(name="drawn", system=system, load=load, output=draw(outputs(system, tolerance)))
