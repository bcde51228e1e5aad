"""What would take minutes is refused before it is begun, and what is quick is not refused."""

import random
from fractions import Fraction

import pytest
from flint import ctx, fmpq

import wavesym
from tests.support.generated import files
from wavesym.errors import CostError, ToleranceError
from wavesym.exact import motion, reference
from wavesym.exact.reference import Reference
from wavesym.numbers.reals import DOUBLE
from wavesym.programs import choice, pieces
from wavesym.programs.choice import choose
from wavesym.scene import lower


class Begun(Exception):
    pass


def begun(*_, **__):
    raise Begun


def drive(kappa, inertia, until, **output):
    return wavesym.Scene(
        name="drive",
        system={"type": "drive", "m": len(kappa), "kappa": kappa, "inertia": inertia},
        load=[{"body": 1, "times": [0], "steps": [1]}],
        output={"until": until, **(output or {"strain": ["1/2"]})},
    )


def record(samples, outputs, until=20):
    drawn = random.Random(2)
    return wavesym.Scene(
        name="record",
        system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
        load=[{"spacing": "1/10", "samples": [drawn.randrange(-100, 100) for _ in range(samples)]}],
        output={"until": until, "tolerance": "1e-8", "strain": [f"{2 * k + 1}/{outputs}" for k in range(outputs)]},
    )


def long_numbers(count):
    drawn = random.Random(3)
    return [f"{drawn.randrange(9 * 10**48, 10**49)}/{drawn.randrange(9 * 10**48, 10**49)}" for _ in range(count)]


@pytest.fixture
def idle(monkeypatch):
    """Nothing that takes long may begin."""
    monkeypatch.setattr(motion, "NetworkWaves", begun)
    monkeypatch.setattr("wavesym.exact.tables.network_table.departures", begun)


def test_numbers_of_99_characters_cost_tables_and_not_windows(idle):
    """Exact tables would have coefficients of tens of thousands of digits; in balls a number is as short as another."""
    scene = drive(long_numbers(3), long_numbers(4), 40)
    with pytest.raises(CostError, match=r"^output.until: the tables would hold .* fewer digits in the scene's numbers"):
        choice.signals(lower(scene), 50_000)
    made = Reference(lower(scene))
    assert made.signals is None
    with pytest.raises(Begun):
        made.values([1.0] * 2000)
    with pytest.raises(Begun):
        choose(lower(scene), "pieces")


@pytest.mark.slow
def test_numbers_of_99_characters_are_generated_and_run():
    scene = drive(long_numbers(3), long_numbers(4), 40)
    assert files(lower(scene), "all")
    assert len(Reference(lower(scene)).values([0.2 * k for k in range(201)])[0]) == 201


@pytest.mark.slow
@pytest.mark.parametrize(("samples", "outputs"), [(200, 100), (200, 300), (1000, 2000)])
def test_a_long_record_is_not_for_closed_forms_nor_large_ones_for_pieces(samples, outputs, idle):
    scene = record(samples, outputs)
    model = lower(scene)
    for asked in (choice._WORTH_TRYING, 1e5):
        with pytest.raises(CostError, match=r"^load: .* increments would arrive at the outputs, the limit"):
            choice.refuse_many(model, asked)
    assert Reference(model).signals is None
    with pytest.raises(pieces._TooLarge if outputs == 2000 else Begun):
        choose(lower(scene), "pieces")


def test_a_building_watched_for_20_is_refused_nothing(idle):
    small = wavesym.Scene(
        name="small",
        system={"type": "building", "m": 2, "kappa": ["1/4", "3/5", "1/5"], "base": "force"},
        load=[{"times": [0], "a": [1], "b": [0]}],
        output={"until": 20, "strain": ["1/2", "3/2"]},
    )
    for name in ("closed", "pieces"):
        with pytest.raises(Begun):
            choose(lower(small), name)
    with pytest.raises(Begun):
        Reference(lower(small)).values([1.0] * 1000)


@pytest.mark.parametrize("until", [2000, 6000])
def test_values_far_out_are_refused_before_the_first(until, idle, monkeypatch):
    """Three unequal shafts lose bits in proportion to the time: their waves would fill the memory."""
    monkeypatch.setattr(motion, "NetworkWaves", real_waves)
    monkeypatch.setattr("wavesym.exact.joints.joint_motion.JointMotion.move", begun)
    with pytest.raises(CostError, match=r"^output"):
        Reference(lower(drive([1, "1/2", "1/3"], [1, 2, 3, 4], until))).values([1.0 * k for k in range(1001)])


real_waves = motion.NetworkWaves


def test_a_heavy_shaft_for_long_is_refused_by_all_but_the_tables(monkeypatch):
    """Rates of 10000 until tau = 200: millions of bits for windows, and polynomials of thousands of powers to march."""
    scene = drive([10000], [1, 1], 200)
    monkeypatch.setattr(motion, "NetworkWaves", begun)
    for name, why in (("pieces", r"\d+ bits would be needed for pieces"), ("march", r"polynomials of degree")):
        with pytest.raises(CostError, match=rf"^output.until: .*{why}"):
            choose(lower(scene), name)
    with pytest.raises(
        ToleranceError,
        match=r"pieces: .*the limit is 1024.*; march: .* polynomials of deg",
    ):
        choose(lower(scene))
    assert Reference(lower(scene)).signals is not None
    three = drive([10000] * 3, [1] * 4, 200)
    with pytest.raises(CostError, match=r"^output.until: the waves of 4 nodes .* bytes, the limit"):
        Reference(lower(three)).values([20.0 * k for k in range(11)])


def fits(scene, tolerance="1e-8"):
    return pieces._Fits(lower(scene), DOUBLE, pieces.rational(Fraction(tolerance)))


@pytest.mark.parametrize(
    ("scene", "per_unit"),
    [
        (drive([1], [1, 2], 7), 1),
        (drive([1], [1, 2], "15/2", strain=["1/3"], velocity=["1/3", "1/2"]), 2),
        (record(13, 4, until=4), 4),
    ],
)
def test_at_least_so_many_pieces_as_foretold_are_made(scene, per_unit):
    """And no more than one unit's worth above that, and a stretch that the last number of the horizon begins."""
    made = fits(scene)
    whole = int(made._motion.until.floor())
    per_window = made._least(per_unit) // whole
    with ctx.workprec(128):
        count = sum(len(grid.powers) * len(grid.outputs) for grid in made.fit_pieces(per_unit).grids)
    assert made._least(per_unit) <= count
    assert count <= made._least(per_unit) + per_window + 2 * len(scene.outputs)


def test_tables_beyond_the_limit_are_refused_before_a_fit(monkeypatch):
    made = fits(drive([1], [1, 2], 7))
    monkeypatch.setattr(pieces._Fits, "_fit", begun)
    size = 8 * made._least(2)
    with pytest.raises(
        pieces._TooLarge, match=r"^output.until: pieces would take at least .*\(a shorter horizon, fewer"
    ):
        made.fit_pieces(2, size - 1)
    with pytest.raises(Begun):
        made.fit_pieces(2, size)


def test_tables_that_travel_times_make_large_say_what_gives_them_a_measure():
    """Bars, and a thin layer of another material."""
    thin = {"rod": "0.01571", "speed": "0.98733333371"}
    system = {"type": "chain", "parts": [{"rod": 1, "velocity": 1}, thin, {"rod": "1.7300001"}, "free"]}
    made = fits(wavesym.Scene(name="layer", system=system, output={"until": 4, "strain": ["1/2"]}))
    with pytest.raises(
        pieces._TooLarge, match=r'\(speed_adjustment = "0.5 %" under \[system\], a shorter horizon, few'
    ):
        made.fit_pieces(2, 8)


def test_a_fit_stops_at_the_limit(monkeypatch):
    """What degrees make of the tables is seen output by output."""
    made = fits(drive([1], [1, 2], 7, strain=["1/3", "1/2"], velocity=["1/3", "1/2"]))
    outputs = []
    right = pieces._Fits._output

    def counted(self, *given):
        outputs.append(given)
        return right(self, *given)

    monkeypatch.setattr(pieces._Fits, "_output", counted)
    with pytest.raises(pieces._TooLarge):
        made.fit_pieces(2, 8 * made._least(2))
    assert len(outputs) == 1


def test_pieces_that_others_have_too_are_made_once(monkeypatch):
    """Where breakpoints are close, pieces of a half are those of a quarter but for the few that are cut."""
    scene = wavesym.Scene(
        name="close",
        system={"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 2]},
        load=[{"body": 1, "times": [f"{k}/10" for k in range(10)], "steps": [1] * 10}],
        output={"until": 3, "strain": ["1/3", "1/2"]},
    )
    made = fits(scene)
    asked, moved = [], []
    segments, shortened = motion.Motion.segments, pieces.shorten
    monkeypatch.setattr(motion.Motion, "segments", lambda *given: asked.append(given) or segments(*given))
    monkeypatch.setattr(pieces, "shorten", lambda *given: moved.append(given) or shortened(*given))
    first = made.fit_pieces(4)
    before = len(moved)
    again = made.fit_pieces(2)
    assert len(asked) == 2
    assert len(moved) - before < made._least(2) / 4
    assert first != again == fits(scene).fit_pieces(2)


def test_one_value_that_needs_many_bits_does_not_cost_the_others(monkeypatch):
    """A strain is exactly 0 at tau = 1, which no bits tell before it is smaller than all doubles; the next is not."""
    monkeypatch.setattr(reference, "_MODERATE", 0)
    load = {"times": [0], "a": [1], "b": ["-4/3"]}
    scene = wavesym.Scene(
        name="zero",
        system={"type": "building", "m": 2, "kappa": [3, "3/5", "1/5"], "base": "force"},
        load=[load],
        output={"until": 2, "strain": ["1/4", "1/2"]},
    )
    lengths = {}
    values = motion._values

    def counted(waves, channels, start, *shared):
        channels = list(channels)
        found = list(values(waves, channels, start, *shared))
        place = min(channel.delay for channel in channels)  # of rods of length 1 the wave that begins nearer
        lengths.setdefault((place, ctx.prec), []).extend(known.polynomial.length() for _, known in found)
        return found

    monkeypatch.setattr(motion, "_values", counted)
    taus = [0.1 * k for k in range(20)] + [1.0]
    first, _ = Reference(lower(scene)).values(taus)
    assert first[-1] == 0.0
    assert lengths[fmpq(1, 4), 2048]
    assert max(lengths[fmpq(1, 2), 128]) <= 33


def test_pieces_take_no_longer_than_they_are_worth_where_a_closed_form_serves(monkeypatch):
    """Fast springs beside joints without mass, between unequal rods, make many stretches and few exponentials."""
    parts = [{"rod": 1, "velocity": 1}, {"joint": True, "spring": 5000}, {"rod": "3/2"}, "fixed"]
    fields = {"system": {"type": "chain", "parts": parts}, "output": {"until": "3/4", "strain": ["3/4"]}}
    model = lower(wavesym.Scene(name="stiff", **fields))
    monkeypatch.setattr(choice, "_OF_MANY", 0.01)
    chosen = choice.choose(model)
    assert chosen.name == "closed"
    assert "s, the limit where another program serves is 0.01 s (--evaluator pieces helps)" in chosen.reason
    monkeypatch.setattr(choice, "_OF_MANY", 5)
    assert " expected where another program serves" not in choice.choose(model.shorten(fmpq(1, 100))).reason
