"""Fronts that no number follows but the last, or none at all: in programs, in values, and in what is proved of both.

The left end of a rod of length 2, whose right end is fixed, has the strain of what acts on it until tau = 4. A contact
in its middle changes nothing, as what comes there presses.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import accumulate

import numpy as np
import pytest
from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.exact.extremes import TrueExtreme, extremes
from wavesym.exact.reference import Reference
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.making import make
from wavesym.programs.request import Request
from wavesym.scene import Scene, lower

ROD = [{"joint": True, "name": "a"}, {"rod": 1}, {"rod": 1}, "fixed"]
CONTACT = [*ROD[:2], "contact", *ROD[2:]]
REALS = pytest.mark.parametrize("real", [DOUBLE, SINGLE], ids=lambda real: real.name)
LITTLE = Fraction(1, 10**25)


def pressed(parts, until, times, steps):
    """The left end under steps."""
    load = {"at": "a", "times": [str(time) for time in times], "steps": [str(step) for step in steps]}
    output = {"until": until, "force": ["0"], "tolerance": "1e-4"}
    return Scene(name="pressed", system={"type": "chain", "parts": parts}, load=[load], output=output)


def last_numbers(until, real):
    """The last but one and the last number of a horizon."""
    last = lower(pressed(ROD, until, [0], [1])).horizon(real)
    return Fraction(real.next_after(last, 0.0)), Fraction(last)


def places(until, real):
    """When steps begin that are seen first at the last number, or at the last two."""
    before, last = last_numbers(until, real)
    found = [[last], [last - LITTLE], [before + LITTLE], [before - LITTLE, before + LITTLE]]
    found += [[Fraction(until)]] * (Fraction(until) > before)
    return [*found, [before + (last - before) * k / 3 for k in (1, 2)]]


def assert_right(parts, until, real, loads, evaluators):
    """Values to the last bit, programs within their bound, extremes true; `loads` are instants and steps."""
    model = lower(pressed(parts, until, *zip(*loads, strict=True)))

    def right(taus):
        return [float(-sum(step for time, step in loads if time <= Fraction(tau))) for tau in taus]

    taus = [0.0, *map(float, last_numbers(until, real))]
    largest = max(map(abs, right(taus)))
    assert Reference(model, real).values(taus)[0] == right(taus)
    for evaluator in evaluators:
        program = make(model, Request(evaluator, real.name))
        (output,) = program.outputs
        assert output.largest >= 0.99 * largest
        assert program.evaluate(np.array(taus))[0] == pytest.approx(right(taus), rel=0, abs=output.bound * largest)
    ((least, greatest),) = extremes(model)
    seen = [step for time, step in loads if time <= Fraction(model.horizon())]
    sums = [*([] if loads[0][1] else [0]), *accumulate(seen)]
    assert (least.value, greatest.value) == (-float(max(sums)), -float(min(sums)))
    for each in (least, greatest):
        assert not each.reached or right([each.tau]) == [each.value]


@pytest.mark.quick(2)
@REALS
@pytest.mark.parametrize("until", ["2.3", "0.1", "3", "10/3"])  # the nearest double is below, above, the number itself
def test_a_front_between_the_last_numbers_is_seen(until, real):
    for k, times in enumerate(places(until, real)):
        loads = list(zip([0, *times], [Fraction(k % 2, 1000), 1, Fraction(3, 2)], strict=False))
        assert_right(CONTACT, until, real, loads, ["pieces"])


@REALS
def test_every_program_sees_it(real):
    for times in places("2.3", real):
        loads = list(zip([0, *times], [Fraction(1, 1000), 1, Fraction(3, 2)], strict=False))
        assert_right(ROD, "2.3", real, loads, ["closed", "pieces"])
    assert_right(ROD, "2.3", DOUBLE, loads, ["march"])


@pytest.mark.parametrize("parts", [ROD, CONTACT], ids=["rod", "contact"])
@pytest.mark.parametrize("first", [0, Fraction(1, 1000)])
def test_what_begins_and_ends_between_two_numbers_is_not_reached(parts, first):
    """No number sees it: programs are as they would be without, and an extreme says so."""
    before, last = last_numbers("2.3", DOUBLE)
    near = [before + (last - before) * k / 3 for k in (1, 2)]
    model = lower(pressed(parts, "2.3", [0, *near], [first, 1, -1]))
    ((least, greatest),) = extremes(model)
    assert least == TrueExtreme(float(-1 - first), float(last), reached=False)
    assert greatest == TrueExtreme(float(-first), 0.0)
    program = make(model, Request("pieces"))
    assert program.evaluate([0.0, float(before), float(last)]).tolist() == [[float(-first)] * 3]
    if first == 0:
        assert (program.outputs[0].bound, program.outputs[0].largest) == (0.0, 0.0)


@REALS
def test_modes_refuse_a_jump_that_only_the_last_number_sees(real):
    """What begins between the end of the horizon, 2.3, and its last number acts; what begins later does not."""
    _, last = last_numbers("2.3", real)
    ramp = {"at": "a", "times": [0, 1], "ramps": [1, -1]}
    scene = pressed(ROD, "2.3", [0], [0]).with_({"output.force": [], "output.velocity": ["0"]})
    for time in (Fraction("2.3"), (Fraction("2.3") + last) / 2, last, last + LITTLE):
        step = {"at": "a", "times": [str(time)], "steps": [1]}
        model = lower(scene.with_({"load": [ramp, step]})).tolerating(fmpq(1, 10))
        if time <= last:
            with pytest.raises(UnservedError, match="support no jump"):
                make(model, Request("modes", real.name))
        else:
            make(model, Request("modes", real.name))
