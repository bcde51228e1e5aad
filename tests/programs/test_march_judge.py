"""The march's verdict: what windows lose is added up to errors of outputs, and alarms ring when they should."""

from dataclasses import replace
from math import inf, sqrt

import numpy as np
import pytest
from flint import fmpq

from tests.programs.test_march_energy import blank
from tests.support.generated import assemble, numpy_text
from wavesym.numbers.reals import DOUBLE, SINGLE
from wavesym.programs.march import run as running
from wavesym.programs.march.bound import Alarm, Roundings, Verdict, judge, largest_wave
from wavesym.programs.march.evaluator import marched
from wavesym.programs.march.plan import RIGHT, plan
from wavesym.programs.march.run import Run
from wavesym.programs.march.tail import tail
from wavesym.programs.schemes.march import Marching, MarchScheme
from wavesym.running.compiled import imported
from wavesym.scene import Scene, lower

PULSE = {"times": [0, "1/3", 2], "a": [1, 0, -1], "b": [0, "1/2", 0]}
# what comes back from a wall that hardly moves is taken up: it is loud at first and then still
STOPPED = {"times": [0, 1, 2, 3], "a": [1, -1, 1, -1], "b": [0] * 4}
OUTPUTS = {"strain": ["1/3", "1+"], "velocity": [2], "displacement": ["1/2", 2]}


def building(until="77/8", load=PULSE, base="force", kappa=("1/3", "3/5", 2), **outputs):
    return Scene(
        name="made",
        system={"type": "building", "m": 2, "kappa": kappa, "base": base},
        load=[load],
        output={"until": until, "tolerance": "1e-3", **(outputs or OUTPUTS)},
    )


def times(load, factor):
    """A load so many times as large."""
    return load | {key: [f"{w}{factor}" if "/" not in str(w) else f"0.5{factor}" for w in load[key]] for key in "ab"}


def summed(prepared, degree, real):
    """The errors and sizes of a verdict, window by window."""
    run = Run(prepared, degree)
    roundings, smooth = Roundings(prepared, run, real), tail(prepared, degree)
    unit, smallest = float(real.roundoff), float(real.smallest)
    energy, energies, weighted, weighted_sums = 0.0, [], [], []
    k = np.arange(degree + 1)
    for block in run.blocks():
        for lost in np.sum(roundings.of(block), axis=0):
            energy += lost
            energies.append(energy)
        for waves in zip(block.before, block.after, strict=True):
            read = [
                [
                    sum(np.abs(half[heard.way, p, heard.column + 1]) for heard in output.heard)
                    for output in prepared.outputs
                ]
                for half in waves
                for p in range(len(prepared.panels))
            ]
            weighted.append(np.max(read @ ((k + 1) * (k + 2) + degree), axis=0))
            weighted_sums.append(np.max(read @ (k + 8 + degree / (k + 1)), axis=0))
    # both waves of an output are sent on this window or the one before; at tau = 0 the rod's own
    stretches, lost = 2 * len(prepared.panels) + 2, 4 * (degree + 3) ** 2 * smallest
    for o, output in enumerate(prepared.outputs):
        right, left = output.heard
        impedance = float(prepared.junctions[left.column].left)
        assert impedance == float(prepared.junctions[right.column].right)
        if right.summed:
            error = 2 * sum(energies) / sqrt(impedance) + 24 * unit * stretches * np.sum(weighted_sums, axis=0)[o]
            yield error + prepared.windows * stretches * lost
        else:
            error = 2 * largest_wave(smooth, prepared, energies[-1] / sqrt(impedance))
            yield error + 12 * unit * np.max(weighted, axis=0)[o] + lost


@pytest.mark.parametrize("size", [1, 3, 64])
@pytest.mark.parametrize(
    ("scene", "real"),
    [
        (building(), DOUBLE),
        (building(base="ground", until="7/2"), DOUBLE),
        (building(load=STOPPED, kappa=(1, "1/1000", 1), strain=["1/3"], velocity=["1/2"]), DOUBLE),
        (building(), SINGLE),
        (building(load=times(PULSE, "e-31")), SINGLE),
        (building(load=times(PULSE, "e-43")), SINGLE),
    ],
    ids=["force", "ground", "stopped", "single", "small", "tiny"],
)
def test_a_verdict_adds_up_all_windows(scene, real, size, monkeypatch):
    monkeypatch.setattr(running, "_BLOCK", size)
    prepared = plan(lower(scene), real)
    verdict = judge(prepared, 12, real)
    largest = sizes(scene, prepared)
    np.testing.assert_allclose(verdict.sizes, largest, rtol=1e-9)
    unit = float(real.roundoff)
    for output, error, expected, top in zip(
        prepared.outputs, verdict.errors, summed(prepared, 12, real), largest, strict=True
    ):
        if not output.heard[0].summed:
            assert error == pytest.approx(1.01 * expected, rel=1e-9, abs=0)
        elif size == 1:
            assert error == pytest.approx(1.01 * (expected + 2 * unit * prepared.windows * top), rel=1e-9, abs=0)
        else:  # what is lost on a block counts from its start on
            assert error > 1.01 * expected


def sizes(scene, prepared):
    """The largest values that the program gives at 17 points of each window, none of them beyond the horizon."""
    made = marched(lower(scene), degree=12)
    text = numpy_text(lower(scene), made).replace("if self._leak >", "if 0 * self._leak >")
    taus = [window + np.linspace(0, min(1, prepared.tau_max - window), 17) for window in range(prepared.windows)]
    return np.max(np.abs(imported(text, "made").evaluate(np.minimum(taus, prepared.tau_max))), axis=(1, 2))


def test_a_verdict_is_relative_to_what_is_certainly_there():
    verdict = Verdict(8, (0.5, 0.0, 2.0, 1.0), (2.5, 0.0, 1.0, 1.0), 0.0, 0.0, True)
    assert verdict.largest == (2.0, 0.0, 0.0, 0.0)
    assert verdict.bounds == (0.25, 0.0, inf, inf)


def test_waves_beyond_the_reach_of_a_format_are_refused():
    load = {"times": [0], "a": ["1e26"], "b": [0]}
    for base, fine in (("force", False), ("ground", True)):  # of 3e26 and of 2e26/2 at most
        scene = building(until="3/4", load=load, base=base)
        if fine:
            assert judge(plan(lower(scene), SINGLE), 12, SINGLE).sizes
        else:
            with pytest.raises(OverflowError, match=r"waves beyond 2e\+26"):
                judge(plan(lower(scene), SINGLE), 12, SINGLE)


def alarmed(blocks, trusted, leak=1.0):
    alarm, rung = Alarm(trusted), []
    for block in blocks:
        alarm.watch(block, np.full(block.excess.shape[1:], leak))
        rung.append(alarm.rung)
    return rung


@pytest.mark.parametrize(
    ("inertia", "times", "windows", "largest"),
    [([1, 1], [0], 1, "velocity"), ([1, 1], [0, 1], 2, "velocity"), ([1, 100], [0], 3, "wave")],
)
def test_a_program_compares_with_the_largest_velocity_or_wave_so_far(inertia, times, windows, largest):
    scene = Scene(
        name="made",
        system={"type": "drive", "m": 1, "kappa": [1], "inertia": inertia},
        load=[{"body": 1, "times": times, "steps": [1, -1][: len(times)]}],
        output={"until": windows, "tolerance": "1e-2", "strain": ["1/2"]},
    )
    program = assemble(marched(lower(scene), degree=8))
    scheme = MarchScheme(program.tables, program.constants, program.tau_max, np.float64)

    def run(trusted):
        scheme.trusted = trusted
        march, sizes = Marching(scheme), {"velocity": [], "wave": []}
        for n in range(windows):
            waves = march.block(n, 1)
            sizes["velocity"].append(np.max(np.abs(march._velocity)))
            sizes["wave"].append(np.max(np.abs(waves[..., 0])))
        return march._leak, sizes

    leak, sizes = run(inf)
    size = max(sizes[largest])
    assert size == max(map(max, sizes.values()))
    run(leak / size * 1.001)
    with pytest.raises(ArithmeticError, match="degree 8 is too low"):
        run(leak / size * 0.999)


def watched(missed, ends=(), means=()):
    """A block of as many windows as there are sums missed; velocities and means of waves one each."""
    block = blank(plan(lower(building())), 8, windows=len(missed))
    for n, part in enumerate(missed):
        block.excess[n, 0, 0], block.excess[n, 1, 2] = part / 4, -3 * part / 4
    for n, end in enumerate(ends):
        block.ends[n, 1, 1] = end
    for n, mean in enumerate(means):
        block.after[n, RIGHT, 0, 1, 0] = mean
    return block


def test_an_alarm_rings_when_what_is_missed_in_all_is_more_than_trusted():
    still = watched([0.0], [-2.0])  # the largest velocity so far is 2
    assert alarmed([still, watched([0.125, 0.125])], 0.125) == [False, False]
    assert alarmed([still, watched([0.125, 0.25])], 0.125) == [False, True]
    assert alarmed([still, watched([0.125]), watched([0.25]), watched([0.0])], 0.125) == [False, False, True, True]
    assert alarmed([still, watched([0.25, 0.25])], 0.125, leak=0.5) == [False, False]
    assert alarmed([still, watched([0.25, 0.5])], 0.125, leak=0.5) == [False, True]
    # the largest so far, and all that was missed so far, whatever the block
    assert alarmed([watched([0.0, 0.0, 0.0], [0.5, -2.0, 1.0]), watched([0.25])], 0.125) == [False, False]
    assert alarmed([watched([0.0, 0.0, 0.0], [0.5, -2.0, 1.0]), watched([0.375])], 0.125) == [False, True]
    assert alarmed([watched([0.125, 0.0], [2.0]), watched([0.0, 0.125])], 0.125) == [False, False]
    assert alarmed([watched([0.125, 0.0625], [2.0]), watched([0.0, 0.125])], 0.125) == [False, True]
    # waves count as velocities do, their higher coefficients do not
    assert alarmed([watched([0.25], [1.0], [-2.0])], 0.125) == [False]
    assert alarmed([watched([0.25, 0.0], [1.0, 1.0], [0.0, -2.0])], 0.125) == [True]
    wiggling = watched([0.25])
    wiggling.after[..., 1:] = 9.0
    assert alarmed([wiggling], 0.125) == [True]


def test_a_verdict_is_quiet_where_its_alarm_is():
    scene = building(until=40)
    trusted = [judge(replace(plan(lower(scene)), trusted=part), 12, DOUBLE).quiet for part in (1e-12, 1.0)]
    assert trusted == [False, True]
    assert plan(lower(scene)).trusted == 1e-3 / 100
    # but what so many nodes round on so many windows is always allowed
    assert plan(lower(building(until=999)), SINGLE).trusted == pytest.approx(3 * 1000 * 2.0**-24)


@pytest.mark.parametrize(
    "extreme",
    [
        {"kappa": ("1e-300", "3/5", 2), "base": "ground"},
        {"load": times(PULSE, "e-299")},
        {"load": PULSE | {"times": [0, "1e-300", 2]}},
        {"kappa": (1, "1e-288", 2)},
    ],
    ids=["nothing", "load", "panel", "ratio"],
)
def test_numbers_too_small_for_their_rounding_are_refused(extreme):
    if "base" in extreme:  # kappa_0 acts nowhere
        assert marched(lower(building(**extreme)), degree=9)
    else:
        with pytest.raises(OverflowError, match="too small for double precision"):
            marched(lower(building(**extreme)), degree=9)


def test_from_the_least_number_on_a_product_is_rounded_as_the_unit_roundoff_says():
    """The least number times u is rounded to u of itself, and a bit less is not."""
    for real in (DOUBLE, SINGLE):
        assert real.least * real.roundoff * real.roundoff == real.smallest
        assert real.least > 0
    assert fmpq(1) > DOUBLE.least
