"""The march of one hat of each record: values within its bound, whatever the spacing, and what it refuses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx, fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

import wavesym
from tests.support.drives import EVERY
from tests.support.generated import numpy_text, program_files
from tests.support.laplace import Laplace
from tests.support.oscillators import el_centro
from tests.support.shaken import SAMPLES, shaken
from wavesym.errors import CostError, SpacingError, ToleranceError, UnservedError
from wavesym.exact.reference import Reference
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import fraction, nearest, rational
from wavesym.programs import hats, schemes
from wavesym.programs.choice import choose
from wavesym.programs.hats import HatMarch, hat_march, split, still
from wavesym.programs.making import program
from wavesym.programs.march.bound import Verdict
from wavesym.programs.march.evaluator import March, judge_march, march
from wavesym.programs.march.plan import readable
from wavesym.programs.schemes.hats import ShiftedHats
from wavesym.programs.schemes.march import Marching
from wavesym.progress import progress
from wavesym.running.compilation import import_text
from wavesym.scene import Scene, lower
from wavesym.verification.collocation import integrate
from wavesym.verification.problem import corner_problem

HALF_ULP = 2.0**-53
PARTS = [{"mass": 2, "name": "a"}, {"rod": 1}, {"mass": 1, "name": "b"}, {"rod": "3/2", "impedance": 2}, "absorbing"]


def chain(load: list[dict[str, Any]], until: object = 6, parts: list[Any] = PARTS) -> Model:
    watched = {"strain": ["1/2", "1+"], "velocity": ["a", "2"], "displacement": ["b"]}
    return lower(
        Scene(
            name="hats",
            system={"type": "chain", "parts": parts},
            load=load,
            output={"until": until, "tolerance": 1e-6, **watched},
        )
    )


def made(model: Model) -> HatMarch:
    found = hat_march(model)
    assert found
    return found


def in_bounds(found: HatMarch, values: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Errors of all outputs in parts of what is allowed; the true values were rounded once."""
    allowed = np.array([output.bound * output.largest for output in found.outputs])
    error = np.maximum(np.abs(values - true).max(axis=1) - HALF_ULP * np.abs(true).max(axis=1), 0)
    return np.where(error == 0, 0, error / np.where(allowed > 0, allowed, 5e-324))


def looked_at(found: HatMarch, most: int = 40) -> np.ndarray:
    """The ends, instants at samples and halfway, and others."""
    taus = found.scheme.evenly(nearest(found.records[0].spacing) / 2)
    some = taus[np.linspace(0, len(taus) - 1, most).astype(int)]
    return np.unique([*some, *np.random.default_rng(1).uniform(0, found.tau_max, most // 2)])


@pytest.mark.quick(1)
@pytest.mark.parametrize("first", [0, 7], ids=["from nothing", "a jump first"])
def test_a_record_that_no_window_takes(first: int) -> None:
    model = shaken([first, *SAMPLES])
    with pytest.raises(
        CostError,
        match=r"times at a spacing of 1.37 leave 26 different remainders of the step 1, the limit in a march is 16",
    ):
        march(model)
    found = choose(replace(model, tolerance=fmpq(1, 10**6)), "march").evaluator
    assert isinstance(found, HatMarch)
    assert found.rest == bool(first)
    taus = looked_at(found)
    exact = np.array(Reference(model).values(taus.tolist()))
    assert np.all(in_bounds(found, program(model, found).evaluate(taus), exact) <= 1)
    assert found.error_bound < 1e-8


def test_a_hat_of_another_width_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    model = shaken([0, *SAMPLES], until=12)
    taus = looked_at(made(model), 12)
    exact = np.array(Reference(model).values(taus.tolist()))
    still = hats.still
    wider = fmpq(10**6 + 1, 10**6)

    def widened(given: Model, load: Any) -> Model:
        model = still(given, load)
        return replace(model, loads=tuple(replace(one, time=one.time * wider) for one in model.loads))

    monkeypatch.setattr(hats, "still", widened)
    found = made(model)
    assert np.all(in_bounds(found, found.scheme.evaluate(taus), exact) > 10)


@cache
def on_every_joint() -> tuple[dict[str, Any], Model, HatMarch]:
    """A chain of every kind of joint, moving from the start, under a record at its gear and another on its ground."""
    table: dict[str, Any] = {
        "name": "every",
        "system": EVERY,
        "load": [
            {"at": "ground", "spacing": "0.31", "samples": [0, 1, "-1/2", 2, 0, 1]},
            {"at": "gear", "spacing": "2/7", "samples": [1, -1, "1/3", 0, 2, "-1/2"]},
        ],
        "output": {
            "until": "5/2",
            "strain": ["1-", "1/4", "side:1/2-"],
            "velocity": ["floor", "hung", "ground", "side:3/2"],
            "displacement": ["seat"],
        },
    }
    model = lower(Scene.model_validate(table))
    return table, model, made(model)


def test_every_kind_of_joint_against_a_laplace_expansion() -> None:
    table, _, found = on_every_joint()
    truth = Laplace(table, fraction(rational(found.tau_max)))
    taus = looked_at(found, 8)
    exact = np.array(
        [
            [float(terms.value(fraction(rational(tau))).mid()) for tau in taus]
            for quantity in ("strain", "velocity", "displacement")
            for terms in (truth.terms(quantity, place) for place in table["output"][quantity])
        ]
    )
    assert (found.rest, len(found.records)) == (1, 2)
    assert found.error_bound < 1e-8
    assert np.all(in_bounds(found, found.scheme.evaluate(taus), exact) <= 1)


@settings(max_examples=6)
@given(
    st.sampled_from(["0.37", "1.000000001", "5/13", "0.123456789012345678"]),
    st.lists(st.integers(-3, 3), min_size=5, max_size=9),
    st.sampled_from([4, "6.3"]),
)
def test_drawn_records(spacing: str, samples: list[int], until: object) -> None:
    model = chain([{"at": "a", "spacing": spacing, "samples": [1, *samples, 1]}], until)
    found = hat_march(model)
    if found is None:  # most samples lie on a line
        return
    taus = looked_at(found, 16)
    exact = np.array(Reference(model).values(taus.tolist()))
    assert np.all(in_bounds(found, found.scheme.evaluate(taus), exact) <= 1)


@pytest.mark.slow
def test_instants_of_one_phase_and_others_have_the_same_values(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a Fourier transform, one by one, and where the march is not kept."""
    model = chain([{"at": "a", "spacing": "0.31", "samples": [1, 2, -1, 3, 0, 1, 5]}], 9)
    found = made(model)
    taus = found.scheme.evenly(0.1)
    together = found.scheme.evaluate(taus)
    alone = np.hstack([found.scheme.evaluate([tau]) for tau in taus])
    monkeypatch.setattr(ShiftedHats, "KEPT", 0)
    monkeypatch.setattr(ShiftedHats, "PAIRS", 7)
    streamed = replace(found).scheme.evaluate(taus[::3])
    allowed = 2 * np.array([[output.bound * output.largest] for output in found.outputs])
    assert np.all(np.abs(together - alone) <= allowed)
    assert np.all(np.abs(together[:, ::3] - streamed) <= allowed)
    assert np.all(np.isnan(found.scheme.evaluate([-1e-9, np.nextafter(found.tau_max, 99), np.nan])))


def test_instants_of_their_own_take_all_outputs_one_march(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the march is not kept."""
    model = chain([{"at": "a", "spacing": "0.31", "samples": [0, 2, -1, 3, 0, 1, 5]}], 4)
    found = made(model)
    own = np.random.default_rng(2).uniform(0, found.tau_max, (len(model.probes), 3))
    one_by_one = np.array([found.scheme.evaluate(taus)[k] for k, taus in enumerate(own)])
    marched = []
    monkeypatch.setattr(ShiftedHats, "KEPT", 0)
    monkeypatch.setattr(schemes.hats, "Marching", lambda *given: marched.append(given) or Marching(*given))
    values = replace(found).scheme.each(own)
    assert len(marched) == 1
    assert np.all(np.abs(values - one_by_one) <= 2 * np.array([[each.bound * each.largest] for each in found.outputs]))


def test_evenly_lie_an_even_number_of_instants_from_sample_to_sample() -> None:
    found = made(chain([{"at": "a", "times": ["0.09", "0.4", "0.71", "1.02"], "ramps": [1, -3, 4, -2]}], 5))
    taus = found.scheme.evenly(0.1)
    begin = found.records[0].begin
    assert (taus[0], taus[-1], begin) == (0.0, found.tau_max, fmpq(9, 100))
    assert np.diff(taus).max() <= 0.1
    places = (taus - 0.09) / 0.31
    inside = np.floor(places[(places > -1e-9) & (places < 15 - 1e-9)] + 1e-9)
    assert set(np.bincount(inside.astype(int)).tolist()) == {4}


def allowed(samples: Sequence[int], error: float, height: float, smooth: int) -> tuple[March, float]:
    """The march of a hat and what is allowed of those of `samples`, where one of 1 is so wrong, so large and level."""
    model = chain([{"at": "a", "spacing": "0.37", "samples": [1, 2, -1, 3, 0, 1, 5]}])
    (record,) = split(model).records
    of_hat, _ = judge_march(still(model, record), degree=smooth)
    verdict = Verdict(smooth, (error,), (height,), 0.0, 0.0, smooth, (height,), (0.0,))
    return of_hat, float(hats._superpose(replace(record, samples=tuple(map(fmpq, samples))), of_hat, verdict)[0, 0])


def test_rounding_of_hats_that_are_added_one_by_one_is_bounded() -> None:
    """Hats of 1 that are right, and every sample, product and sum too large by u."""
    count = 2000
    _, most = allowed([1] * count, 1e-300, 1.0, 8)
    with ctx.workprec(300):
        more = 1 + arb(2) ** -53
        total = arb(0)
        for _ in range(count):
            total = (total + more * more) * more
        lost = float((total - count).mid())
    assert lost <= most <= 4 * lost


def test_rounding_of_fourier_transforms_is_bounded() -> None:
    """A sample of 1 among zeros, and a hat whose values are all 1.

    Each of three transforms in t levels is wrong by at most t eta of the product of Euclid's norms, with
    eta = u + 4 sqrt(2) u (N. J. Higham, Accuracy and Stability of Numerical Algorithms, theorem 24.2; of the last one
    by Cauchy and Schwarz).
    """
    count = 2000
    _, most = allowed([1, *[0] * (count - 1)], 1e-300, 1.0, 8)
    lost = 3 * np.log2(2 * count) * (1 + 4 * np.sqrt(2)) * 2.0**-53 * np.sqrt(count)
    assert lost <= most <= 4 * lost


def test_hats_that_are_read_on_the_next_panel_are_bounded() -> None:
    """What is computed is 0, and 2 from an edge on; the truth is a polynomial within 1 that reaches 1 at that edge.

    So both panels are within 1 of it. It is as steep there as can be, and is read as much later as counts as one phase.
    """
    smooth = 18
    of_hat, most = allowed([1], 1.0, 2.0, smooth)
    late = rational(ShiftedHats.NEAR * of_hat.tau_max)
    shortest = min(panel.length for panel in of_hat.plan.panels)
    with ctx.workprec(300):
        before = arb(1 - 2 * late / shortest).chebyshev_t(smooth)
        lost = float((1 - before).mid())  # besides the 1 of a panel by itself
    assert 1e-13 < lost <= most - 1 <= 10 * lost


def test_what_no_record_is_stays_as_it_is() -> None:
    """What a record jumps by, and a load of few instants, are marched beside it."""
    loads = [
        {"at": "a", "times": [0, "0.31", "0.62", "0.93"], "steps": [1, 0, -2, 0], "ramps": [1, -3, 4, -2]},
        {"at": "b", "times": [0, "1/2"], "steps": [1, -1]},
    ]
    model = chain(loads, 5)
    parts = split(model)
    (sampled,) = parts.records
    assert (sampled.begin, sampled.spacing) == (0, fmpq(31, 100))
    assert sampled.samples[:4] == tuple(fmpq(n, 100) for n in (131, 69, -69, -69))
    assert sorted((load.source, load.time) for load in parts.rest) == [
        ("a:ramp", 0),
        ("a:ramp", fmpq(31, 100)),
        ("a:ramp", fmpq(62, 100)),
        ("a:ramp", fmpq(93, 100)),
        ("a:step", 0),
        ("a:step", fmpq(62, 100)),
        ("b:step", 0),
        ("b:step", fmpq(1, 2)),
    ]
    found = made(model)
    taus = looked_at(found, 12)
    exact = np.array(Reference(model).values(taus.tolist()))
    assert np.all(in_bounds(found, found.scheme.evaluate(taus), exact) <= 1)


def test_what_a_march_cannot_have_is_named_and_what_helps() -> None:
    jumps = [{"at": "a", "times": [f"{k * (10**9 - 1)}/{10**9}" for k in range(20)], "steps": [1] * 20}]
    with pytest.raises(SpacingError) as refusal:
        choose(chain(jumps, 25), "march")
    line = str(refusal.value)
    assert "times at a spacing of 0.999999999 leave" in line
    assert "of the step 0.5, the limit in a march is 16" in line
    smooth = chain([{"at": "a", "spacing": "4.999999999", "samples": [0, *SAMPLES]}], 120)
    with pytest.raises(SpacingError, match=r"spacing of 4.999999999 leave 25 .* \(a spacing of 5, fewer samples"):
        march(smooth)
    with pytest.raises(SpacingError, match=r"spacing of 4\.999999999"):
        choose(smooth, "march", "single")
    long = chain([{"at": "a", "spacing": "1/10000", "samples": [0, *SAMPLES]}], 11)
    with pytest.raises(
        SpacingError,
        match=r"a has 110002 samples on the horizon at a spacing of 0.0001, the limit in a march of one hat is 100000",
    ):
        made(long)
    with pytest.raises(ToleranceError, match=r"march: hats added up leave a bound of \S+ to tau = 6 for"):
        choose(chain([{"at": "a", "spacing": "0.137", "samples": SAMPLES}]).tolerating(fmpq(1, 10**14)), "march")


@pytest.mark.slow
def test_auto_takes_it_where_nothing_else_serves() -> None:
    load = [{"at": "b", "spacing": "0.137", "samples": SAMPLES * 40}]
    choice = choose(chain(load, 130))
    assert isinstance(choice.evaluator, HatMarch)
    assert choice.name == "march"
    assert "march of one hat" in choice.reason


def test_a_command_says_what_a_jump_costs_and_what_would_let_modes_serve(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Before it marches, once, also where standard error is a file; nothing from Python."""

    def refused(*_: object) -> None:
        raise CostError("a march")

    monkeypatch.setattr(hats, "judge_march", refused)

    def lines(first: int, until: int) -> int:
        for _ in range(2):
            with pytest.raises(CostError, match="a march"):
                hat_march(shaken([first, *SAMPLES], until=until))
        return capsys.readouterr().err.count("as a load jumps: modes, which are sooner, take one that does not")

    assert lines(7, 20_000) == 0
    found = []
    for first, until in ((7, 20_000), (0, 20_000), (7, 36)):
        with progress("work"):
            found.append(lines(first, until))
    assert found == [1, 0, 0]


def test_numbers_are_readable() -> None:
    assert [readable(value) for value in (fmpq(1, 3), 5 - fmpq(1, 10**9), fmpq(5))] == ["1/3", "4.999999999", "5"]
    assert readable(fmpq(10**40, 3 * 10**40 + 1)) == "0.33333333333333331"


def test_there_is_numpy_and_no_c() -> None:
    _, model, found = on_every_joint()
    with pytest.raises(UnservedError, match="NumPy or run, helps"):
        program_files(model, replace(found, refusal="load: many (NumPy or run, helps)"), "c")
    text = numpy_text(model, found)
    taus = looked_at(found, 8)
    assert np.array_equal(import_text(text, "every").evaluate(taus), program(model, found).evaluate(taus))


# layers of 51 ms and twice 34 ms on rock that has no end, under samples 20 ms apart
LAYERS = [
    {"motion": "acceleration", "name": "outcrop"},
    {"dashpot": "20/7"},
    {"rod": 1},
    {"rod": "2/3", "impedance": "19/35"},
    {"rod": "2/3", "impedance": "34/105"},
    "free",
]
SPACING = fmpq(20, 51)


def outcrop(samples: list[float], taus: np.ndarray) -> np.ndarray:
    """The integral of what is linear between samples, and constant after the last."""
    h = nearest(SPACING)
    a = np.array([*samples, *[samples[-1]] * (int(taus.max() / h) + 2)])
    v = np.concatenate([[0.0], np.cumsum(h * (a[1:] + a[:-1]) / 2)])
    k = (taus / h).astype(int)
    s = taus - k * h
    return v[k] + s * a[k] + s * s / 2 * (a[k + 1] - a[k]) / h


def layered(samples: list[float], phase: np.ndarray, steps: int) -> np.ndarray:
    """Velocities of the base and of the surface, and the strain on the first interface: (3, steps, phases).

    At phase + n/3, from instant to instant: without bodies, what leaves an interface is what arrived, in parts.
    """
    z0, (z1, z2, z3) = 20 / 7, (1.0, 19 / 35, 34 / 105)
    given = outcrop(samples, phase + np.arange(steps)[:, None] / 3)
    up, down = np.zeros((2, 3, steps + 3, len(phase)))  # what is sent into the layers' lower and upper ends
    found = np.zeros((3, steps, len(phase)))
    for n in range(steps):
        at = n + 3
        a1, a2, a3 = (up[k, at - lag] for k, lag in enumerate((3, 2, 2)))
        b1, b2, b3 = (down[k, at - lag] for k, lag in enumerate((3, 2, 2)))
        base = (z0 * given[n] + 2 * z1 * b1) / (z0 + z1)
        first = 2 * (z1 * a1 + z2 * b2) / (z1 + z2)
        second = 2 * (z2 * a2 + z3 * b3) / (z2 + z3)
        up[:, at] = base - b1, first - b2, second - b3
        down[:, at] = first - a1, second - a2, a3
        found[:, n] = base, 2 * a3, b2 - (first - b2)
    return found


@pytest.mark.parametrize("count", [60, pytest.param(1559, marks=pytest.mark.slow)])
def test_layers_on_rock_under_el_centro_are_what_waves_from_layer_to_layer_make(count: int) -> None:
    exact = el_centro()[:count]
    load = {"at": "outcrop", "spacing": str(SPACING), "samples": [fraction(value) for value in exact]}
    until = fraction(SPACING * (count - 1))
    watched = {"velocity": ["0+", "7/3"], "strain": ["1+"]}
    output = {"until": until, "tolerance": 1e-6, **watched}
    model = lower(Scene(name="soil", system={"type": "chain", "parts": LAYERS}, load=[load], output=output))
    found = made(model)
    phase = np.array([0.0, 1 / 16, 0.2, 0.3])
    steps = int(3 * found.tau_max) - 1
    base, surface, strain = layered(list(map(nearest, exact)), phase, steps)
    taus = phase + np.arange(steps)[:, None] / 3
    true = np.array([each.ravel() for each in (strain, base, surface)])
    values = found.scheme.evaluate(taus.ravel())
    error = np.abs(values - true).max(axis=1)
    allowed = np.array([made.bound * made.largest for made in found.outputs])
    assert np.all(error <= allowed + 1e-12 * np.abs(true).max(axis=1))
    assert np.all(error <= 1e-11 * np.abs(true).max(axis=1))
    assert found.error_bound < 1e-7


@pytest.mark.slow
def test_what_users_call_takes_it() -> None:
    samples = [fraction(value) for value in el_centro()]
    scene = Scene(
        name="soil",
        system={"type": "chain", "parts": LAYERS},
        load=[{"at": "outcrop", "spacing": str(SPACING), "samples": samples}],
        output={"until": 610, "tolerance": 1e-6, "velocity": ["7/3"]},
    )
    response = wavesym.evaluator(scene)
    _, surface, _ = layered(list(map(nearest, el_centro())), np.array([0.1]), 600)
    assert response(0.1 + np.arange(600) / 3)[0] == pytest.approx(surface[:, 0], abs=1e-11)
    assert response.program
    assert (response.program.kernel, response.program.evaluator) == ("hats", "march")
    peaks = wavesym.summary(scene)
    assert peaks.how.startswith("march at ")
    assert peaks.outputs[0].max.value >= surface.max() - 1e-11


DAMPERS = [
    {"motion": "acceleration", "name": "ground"},
    {"rod": 1, "spring": "1/5", "dashpot": "1/2"},
    {"mass": 2, "name": "floor1"},
    {"rod": 1, "dashpot": "1/4"},
    {"mass": 2, "name": "floor2"},
    {"rod": 1, "dashpot": "1/4"},
    {"mass": 1, "name": "roof"},
]


@pytest.mark.slow
def test_dampers_between_floors_under_el_centro_are_what_collocation_says() -> None:
    """It starts from the wave equation and cuts its windows at every sample."""
    samples = [fraction(value) for value in el_centro()[:60]]
    load = {"at": "ground", "spacing": "0.37", "samples": samples}
    watched = {"velocity": ["floor1", "roof"], "strain": ["1/2", "1+"], "displacement": ["roof"]}
    output = {"until": 22, "tolerance": 1e-6, **watched}
    model = lower(Scene(name="dampers", system={"type": "chain", "parts": DAMPERS}, load=[load], output=output))
    found = made(model)
    taus = np.random.default_rng(2).uniform(0, 22, 60)
    values = found.scheme.evaluate(taus)
    motions = [integrate(corner_problem(model), 22.0, points) for points in (8, 16)]
    coarse, fine = (motion.outputs(taus) for motion in motions)
    largest = np.abs(fine).max(axis=1)
    between = np.abs(fine - coarse).max(axis=1)
    rounding = motions[-1].output_roundoff
    assert np.all(between + rounding < 1e-9 * largest), (between, rounding)
    assert np.all(np.abs(values - fine).max(axis=1) <= between + rounding)
    assert found.error_bound < 1e-7
