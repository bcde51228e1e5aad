"""At the end of a horizon, and where values are tiny: what a bound says of the program holds against the truth.

Just after a wave has come an output is a high power of what is left of the horizon, so that what is one number further
would be far larger, and values may be below the normal numbers.
"""

from __future__ import annotations

from fractions import Fraction
from math import isinf, nextafter

import numpy as np
import pytest
from flint import arb

import wavesym
from tests.support.generated import assemble, files
from tests.support.truth import Truth
from wavesym.exact.tables.signal import signals
from wavesym.numbers.doubles import rational
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs import choice, pieces
from wavesym.programs.closed_form import closed_form
from wavesym.running.compilation import compile_files, import_text
from wavesym.scene import lower

BUILDING = {"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"}


def drive(m, until, tolerance="1e-4", step=1, **outputs):
    """A moment steps on the first body of m + 1; far from it outputs begin with a high power."""
    system = {"type": "drive", "m": m, "kappa": [1] * m, "inertia": [1] * (m + 1)}
    load = [{"body": 1, "times": [0], "steps": [step]}]
    return wavesym.Scene(
        name="drive", system=system, load=load, output={"until": until, "tolerance": tolerance, **outputs}
    )


SCENES = {
    "6 + 1 ulp": drive(6, Fraction(nextafter(6, 7)), displacement=[6]),
    "3.0000001": drive(3, "3.0000001", "1e-2", velocity=[3]),
    "8.00001": drive(8, "8.00001", velocity=[8]),
    "1e-200": drive(2, "1e-200", displacement=[0]),
    "1e-40": drive(2, 4, "1e-6", step="1e-40", strain=["1/2"]),
    "10/3": wavesym.Scene(
        name="jump",
        system=BUILDING,
        load=[{"times": [0, "10/3"], "a": [1, -1], "b": [0, 0]}],
        output={"until": "3.3333333", "tolerance": "1e-5", "strain": [0]},
    ),
}

SCENES["2.3"] = SCENES["10/3"].with_(
    {"load[0].times": [0, "2.3"], "load[0].a": ["1/1000", 1], "output.until": "2.3", "output.strain": [0]}
)


def closed(scene, real):
    return closed_form(signals(lower(scene), real=real), lower(scene).horizon(real), real)


def fitted(scene, real):
    return pieces.pieces(lower(scene), real, rational(scene.output.tolerance))


MAKERS = {"closed": closed, "pieces": fitted}
CASES = [
    ("closed", SINGLE, "10/3"),
    ("closed", SINGLE, "1e-40"),
    ("pieces", DOUBLE, "6 + 1 ulp"),
    ("pieces", SINGLE, "6 + 1 ulp"),
    ("pieces", SINGLE, "3.0000001"),
    ("pieces", SINGLE, "8.00001"),
    ("pieces", DOUBLE, "1e-200"),
    ("pieces", SINGLE, "1e-40"),
    *((maker, real, "2.3") for maker in ("closed", "pieces") for real in (DOUBLE, SINGLE)),
]


def holds(scene, form) -> bool:
    """Whether its program's errors are all within the bound, at check points and between."""
    module = assemble(form)
    truth = Truth(scene, Fraction(form.tau_max))
    taus = [form.real.nearest(rational(form.tau_max * k / 40)) for k in range(41)]
    taus = sorted({*form.check_points, *taus})
    for row, (k, output) in zip(module.evaluate(np.array(taus)), enumerate(form.outputs), strict=True):
        allowed = arb(output.bound) * truth.largest(k, Fraction(form.tau_max))[1]
        for tau, value in zip(taus, row.tolist(), strict=True):
            if not (isinf(output.bound) or abs(truth.value(k, Fraction(tau)) - arb(value)) <= allowed):
                return False
    return True


def test_a_pulse_counts_from_its_arrival_not_from_the_next_number():
    """A ramp that begins at 1000/3, up to a millionth later: a last place of tau is much of it."""
    scene = wavesym.Scene(
        name="ramp",
        system=BUILDING,
        load=[{"times": ["1000/3"], "a": [0], "b": [1]}],
        output={"until": "333.333334", "tolerance": "1e-12", "strain": [0]},
    )
    made = files(lower(scene), "all", "closed")
    truth = Truth(scene, scene.output.until)
    taus = np.linspace(1000 / 3 + 1e-9, 333.333334, 20).tolist()
    with compile_files(made, 1) as program:
        found = [program(taus)[0], import_text(made["ramp.py"], "made").evaluate(taus)[0]]
    allowed = arb(import_text(made["ramp.py"], "made").ERROR_BOUND) * truth.largest(0, scene.output.until)[1]
    for values in found:
        for tau, value in zip(taus, values.tolist(), strict=True):
            assert abs(truth.value(0, Fraction(tau)) - arb(value)) <= allowed


@pytest.mark.quick(3)
@pytest.mark.parametrize(("maker", "real", "name"), CASES, ids=lambda each: getattr(each, "name", each))
def test_no_error_is_above_the_bound(maker, real, name):
    assert holds(SCENES[name], MAKERS[maker](SCENES[name], real))


def test_a_jump_at_the_last_single_is_not_left_out(monkeypatch):
    """0 from tau = 10/3 on, which lies after the last double of the horizon, and before the last single."""
    scene = SCENES["10/3"]
    form = closed(scene, SINGLE)
    assert Truth(scene, Fraction(form.tau_max)).value(0, Fraction(form.tau_max)) == 0
    left_out = closed_form(signals(lower(scene)), form.tau_max, SINGLE)
    assert not holds(scene, left_out)
    # and so it is in what a user asks for
    assert choice.choose(lower(scene), "closed", "single").evaluator == form


def beyond(cuts, piece, polynomial):
    """The largest value of all of a piece, which ends one number further than the horizon."""
    return max(abs(polynomial(arb(t))).lower() for t in (-1, 0, 1))


@pytest.mark.parametrize(("real", "name"), [(DOUBLE, "6 + 1 ulp"), (SINGLE, "3.0000001"), (SINGLE, "8.00001")])
def test_a_largest_value_from_beyond_the_horizon_is_seen(monkeypatch, real, name):
    monkeypatch.setattr(pieces._Cuts, "size", beyond)
    monkeypatch.setattr(pieces, "_underflow", lambda powers, real: arb(0))
    assert not holds(SCENES[name], fitted(SCENES[name], real))


@pytest.mark.parametrize(("real", "name"), [(DOUBLE, "1e-200"), (SINGLE, "6 + 1 ulp"), (SINGLE, "1e-40")])
def test_what_underflows_is_seen_where_it_is_not_in_the_bound(monkeypatch, real, name):
    monkeypatch.setattr(pieces, "_underflow", lambda powers, real: arb(0))
    scene = SCENES[name]
    assert not holds(scene, fitted(scene, real))


def test_what_is_tiny_is_not_given_up():
    """70000 smallest numbers of single precision: a few of them are lost."""
    assert closed(SCENES["1e-40"], SINGLE).error_bound < 1e-3
