"""The choice among evaluators: by proved bound and by work, with the reason told; on evaluators made by hand."""

import re
from dataclasses import dataclass, field
from fractions import Fraction
from types import SimpleNamespace

import pytest

import wavesym
from wavesym.errors import CostError, RangeError, ToleranceError
from wavesym.numbers.reals import REALS
from wavesym.programs import choice
from wavesym.programs.choice import Attempt, attempts, choose
from wavesym.scene import lower


@dataclass
class Made:
    """As much of an evaluator as is looked at, and what it was asked."""

    name: str
    error_bound: float
    work: float = 1.0
    asked: list = field(default_factory=list)

    def __call__(self, *asked):
        self.asked.append(asked)
        return self

    @property
    def summary(self):
        return f"{self.name} is good to {self.error_bound:g}"

    def shortfall(self, tolerance):
        return f"{self.name}: {self.error_bound:g} at best"


def costly(*_):
    raise CostError("output.until: 9 coins, at most 5 expected (saving helps)")


def beyond(*_):
    raise OverflowError


@pytest.fixture
def makers(monkeypatch):
    def set_to(**given):
        monkeypatch.setattr(choice, "MAKERS", {"closed": costly, "pieces": costly, "march": costly, **given})
        return SimpleNamespace(**given)

    return set_to


def scene(tolerance="1/1024"):
    return wavesym.Scene(
        name="chosen",
        system={"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 1]},
        load=[{"body": 1, "times": [0], "steps": [1]}],
        output={"until": 3, "tolerance": tolerance, "strain": ["1/2"]},
    )


def test_the_one_with_less_work_is_taken(makers):
    for closed, pieces, best in ((5, 3, "pieces"), (3, 5, "closed"), (3, 3, "closed")):
        makers(closed=Made("closed", 1e-9, closed), pieces=Made("pieces", 1e-8, pieces))
        chosen = choose(lower(scene()))
        other = "closed is good to 1e-09" if best == "pieces" else "pieces is good to 1e-08"
        mine = "pieces is good to 1e-08" if best == "pieces" else "closed is good to 1e-09"
        assert chosen.name == best == chosen.evaluator.name
        assert chosen.reason == f"{other}, takes longer; {mine}"


def test_a_bound_that_is_the_tolerance_meets_it_and_one_above_does_not(makers):
    makers(pieces=Made("pieces", 2.0**-10))
    assert choose(lower(scene())).name == "pieces"
    makers(pieces=Made("pieces", 2.0**-10 + 2.0**-60))
    with pytest.raises(
        ToleranceError,
        match=r"^output.tolerance: 0.000976562 cannot be met; write 2e-03 or more \(closed: output.until: 9 coins, ",
    ):
        choose(lower(scene()))
    makers(pieces=Made("pieces", float("inf")))
    with pytest.raises(ToleranceError, match="inf at best"):
        choose(lower(scene("999/1000")))
    makers(pieces=Made("pieces", 0.99))
    assert choose(lower(scene("999/1000"))).name == "pieces"
    makers(pieces=Made("pieces", 0.9995))
    with pytest.raises(ToleranceError):
        choose(lower(scene("999/1000")))


def test_a_march_is_made_only_where_nothing_else_does(makers):
    made = makers(pieces=Made("pieces", 1e-9), march=Made("march", 1e-9, 0.1))
    assert choose(lower(scene())).name == "pieces"
    assert not made.march.asked
    assert choose(lower(scene()), "march").name == "march"
    made = makers(pieces=Made("pieces", 1), march=Made("march", 1e-9))
    chosen = choose(lower(scene()))
    assert chosen.name == "march"
    assert chosen.reason == (
        "closed: output.until: 9 coins, at most 5 expected (saving helps); pieces: 1 at best; march is good to 1e-09"
    )


def test_only_the_one_asked_for_is_made(makers):
    made = makers(closed=Made("closed", 1e-9), pieces=Made("pieces", 1), march=Made("march", 1e-9))
    assert choose(lower(scene()), "closed", "single") == (
        "closed",
        made.closed,
        "closed is good to 1e-09",
        lower(scene()),
    )
    assert made.closed.asked == [(lower(scene()), REALS["single"], True, "size", False)]
    assert not made.pieces.asked + made.march.asked
    with pytest.raises(ToleranceError, match=r"cannot be met \(pieces: 1 at best\)$"):
        choose(lower(scene()), "pieces")
    choose(lower(scene()))
    assert made.closed.asked[1:] == [(lower(scene()), REALS["double"], False, "speed", False)]


def test_the_tolerance_that_a_refusal_names_is_met():
    fine = wavesym.Scene.from_toml("building_m2").with_({"output.tolerance": "1e-17"})
    with pytest.raises(ToleranceError, match=r"^output.tolerance: 1e-17 cannot be met; write ") as refused:
        choose(lower(fine))
    assert "helps" not in str(refused.value)
    named = str(refused.value).partition("write ")[2].split()[0]
    assert choose(lower(fine.with_({"output.tolerance": named}))).name == "pieces"


def test_what_was_asked_for_says_why_it_is_refused(makers):
    makers(closed=beyond)
    with pytest.raises(CostError, match="9 coins"):
        choose(lower(scene()), "pieces")
    with pytest.raises(RangeError, match=r"^output: closed needs numbers beyond the range of single precision$"):
        choose(lower(scene()), "closed", "single")
    with pytest.raises(
        ToleranceError,
        match=r"closed: numbers beyond the range of double precision; pieces: output.until: 9 coins, .*; march: output",
    ):
        choose(lower(scene()))


RECORDS = {"31.37": (60, 1900, 60), "1/200": (400, 200, 200)}


@pytest.mark.quick(1)
@pytest.mark.parametrize("spacing", RECORDS)
def test_of_a_record_that_is_too_much_all_the_causes_are_told(spacing):
    """Modes and a march of one hat take what does not jump; nothing takes so many jumps."""
    count, until, parts = RECORDS[spacing]
    record = wavesym.Scene(
        name="record",
        system={"type": "building", "m": 3, "kappa": ["1/4", "3/5", "3/5", "1/5"], "base": "ground"},
        load=[
            {
                "times": [k * Fraction(spacing) for k in range(count)],
                "a": [(37 * k * k) % 101 - 50 for k in range(count)],
                "b": [0] * count,
            }
        ],
        output={"until": until, "tolerance": "1e-6", "strain": [f"{k}/20" for k in range(1, 20)]},
    )
    with pytest.raises(ToleranceError) as told:
        choose(lower(record))
    line = str(told.value)
    spaced = {"31.37": "31.37", "1/200": "0.005"}[spacing]
    assert (
        f"march: load: times at a spacing of {spaced} leave {parts} different remainders of the step 1, the limit"
        in line
    )
    assert re.search(r"closed: load: \S+ increments would arrive at the outputs, the limit is 5.0e\+04", line)
    assert re.search(r"pieces: load: 4 nodes times \d+ units of tau are \d+ stretches between loads, the limit", line)
    assert "modes: " not in line  # which are for something else
    assert line.count(" help") == 3
    assert "\n" not in line
    assert len(line) < 700


def test_what_was_tried(makers):
    """The form, or the sentence of its refusal, or both; no march where another will do."""
    made = makers(pieces=Made("pieces", 1e-8), march=Made("march", 1))
    closed, pieces = attempts(lower(scene()))
    assert (closed.form, closed.refusal) == (None, "output.until: 9 coins, at most 5 expected (saving helps)")
    assert isinstance(closed.error, CostError)
    assert pieces == Attempt("pieces", made.pieces)
    assert made.march.asked == []
    makers(closed=beyond, march=Made("march", 1))
    closed, _, march = attempts(lower(scene()), "single", "size")
    assert closed.refusal == "numbers beyond the range of single precision"
    assert (march.refusal, march.why, march.error) == ("1 at best", "march: 1 at best", None)


def test_closed_forms_are_made_of_small_tables_unless_asked_for(monkeypatch):
    """A hundred outputs, and loads that come later, bring 2 * 100 * 300 increments."""
    later = [{"body": 1, "times": [0, "1/2"], "steps": [1, -1]}]
    places = [f"{k}/101" for k in range(1, 101)]
    many = wavesym.Scene(
        name="many",
        system={"type": "drive", "m": 1, "kappa": [1], "inertia": [1, 1]},
        load=later,
        output={"until": 600, "strain": places},
    )
    monkeypatch.setattr(choice, "signals", lambda scene, most, real: (scene, most, real))
    monkeypatch.setattr(choice, "closed_form", lambda signals, tau_max, real: (signals, tau_max, real))
    double = REALS["double"]
    with pytest.raises(CostError, match=r"^load: 6.0e\+04 increments would arrive"):
        choice._make_closed(lower(many), double, False, None)
    assert choice._make_closed(lower(many), double, True, None) == ((lower(many), float("inf"), double), 600.0, double)
    assert choice._make_closed(lower(scene()), double, False, None) == ((lower(scene()), 50_000, double), 3.0, double)
