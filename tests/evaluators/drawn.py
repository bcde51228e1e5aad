"""Scenes drawn by Hypothesis: small systems of all kinds, equal and nearly equal parameters always among them."""

from fractions import Fraction

from hypothesis import strategies as st

import wavesym

_fractions = st.fractions(min_value=Fraction(1, 12), max_value=3, max_denominator=12)
_kappas = st.one_of(
    st.sampled_from([Fraction(1, 2), Fraction(1), Fraction(11, 10), Fraction(1000001, 10**6)]), _fractions
)


@st.composite
def scenes(draw, tolerance="1e-10"):
    """A scene with a strain, a velocity and a displacement, on and off the nodes, under loads on and off integers."""
    kind = draw(st.sampled_from(["collision", "drive", "building"]))
    m = draw({"collision": st.sampled_from([4, 6]), "drive": st.integers(1, 3), "building": st.integers(2, 3)}[kind])
    place = st.fractions(min_value=0, max_value=m, max_denominator=6)
    inside = place.filter(lambda x: x.denominator > 1)

    def numbers(count, values=_kappas):
        return draw(st.lists(values, min_size=count, max_size=count))

    system = {"type": kind, "m": m}
    loads = []
    if kind == "collision":
        velocities = sorted(numbers(m // 2, st.sampled_from([1, 0, "1/3", -1])), key=Fraction, reverse=True)
        system |= {"kappa": numbers(m // 2), "velocity": [1, *velocities[1:]]}
    elif kind == "drive":
        system |= {"kappa": numbers(m), "inertia": numbers(m + 1)}
        loads = [
            {"body": draw(st.integers(1, m + 1)), "times": [0, "4/3"], "steps": [1, draw(st.sampled_from([-1, 2]))]}
        ]
    else:
        system |= {"kappa": numbers(m + 1), "base": draw(st.sampled_from(["force", "ground"]))}
        loads = [{"times": [0, "7/10"], "a": [1, 0], "b": [0, draw(st.sampled_from([0, "-1/3"]))]}]
    output = {
        "until": draw(st.sampled_from([3, "13/3", 7])),
        "tolerance": tolerance,
        "strain": [draw(inside)],
        "velocity": [draw(place)],
        "displacement": [draw(place)],
    }
    return wavesym.Scene(name="drawn", system=system, load=loads, output=output)
