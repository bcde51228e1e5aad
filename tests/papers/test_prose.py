"""The sentences of section 4: every word in a place is evaluated."""

import pytest

from wavesym.papers.pielorz1979.paper import ADAPTERS
from wavesym.papers.pielorz1979.solutions import SOLUTIONS
from wavesym.papers.pielorz1979.statements import STATEMENTS
from wavesym.papers.pielorz1979.transcript import entry, patterns
from wavesym.papers.record import judge


def verdict(id: str, before: str = "", after: str = "") -> str:
    """The verdict on a sentence or formula with one piece of what holds changed."""
    told = entry(id)
    if told.slip:
        assert before in told.slip.correction
        slip = told.slip.model_copy(update={"correction": told.slip.correction.replace(before, after)})
        told = told.model_copy(update={"slip": slip})
    else:
        assert before in told.statement
        place = "english" if told.english else "printed"
        told = told.model_copy(update={place: told.statement.replace(before, after)})
    return judge(told, ADAPTERS[told.kind](told)).verdict


def test_every_pattern_has_cases() -> None:
    names = {pattern.name for pattern in patterns() if "figure" not in pattern.data}
    assert names == STATEMENTS.keys() | SOLUTIONS.keys()


@pytest.mark.quick(9)
@pytest.mark.parametrize(
    ("id", "before", "after"),
    [
        ("text.2", "even", "whole"),
        ("text.4", "give the derivatives of m", "give the derivatives of 2m"),
        ("text.T4", r", if 2 \kappa_1 and \kappa_m are different", ""),
        ("text.T4", r"2 \kappa_1 and \kappa_m", "all rates"),
        ("text.T2", " and all rates are different", ""),
        ("text.T3", ", if all rates are different", ""),
        ("(4.9).F", "times power k", "times power l"),
        ("(4.10).F", "moment number s", "moment number i"),
        ("(4.12).F", "part number k", "part number i"),
        ("text.5", ", once they have arrived", ""),
        ("text.6", "increments", "functions"),
        ("text.7", "g'_{1,n+1}(z)", "g'_{2,n+1}(z)"),
        ("text.8", "g'_{i,1}(z)", "g'_{i,2}(z)"),
        ("text.9", "all rigid bodies but the foundation", "all rigid bodies"),
        ("text.9.powers", "reflected, let through or sent", "reflected"),
        ("text.10", "every 4", "every 2"),
        ("text.12", "then fall", "then rise"),
        ("text.12.group", "2r+1", "2r"),
        ("text.13.K_2", "n+r", "n-r"),
        ("text.13.coefficients", "F^{i,s,d}", "F^{k,s,d}"),
        ("text.13.strains", "the derivatives", "the integrals of the derivatives"),
    ],
)
def test_another_word_is_seen(id: str, before: str, after: str) -> None:
    assert verdict(id, before, after) == "untested"


def test_ranges_of_powers_are_judged() -> None:
    told = entry("text.13.K_1")
    for last in ("2r-r_0+1", "2r-r_0-1"):
        changed = told.model_copy(update={"ranges": (rf"l=1, 2, \dots, {last}",)})
        assert judge(changed, ADAPTERS[changed.kind](changed)).verdict == "untested"


def test_a_sentence_or_a_range_that_means_nothing_is_a_verdict() -> None:
    told = entry("text.11").model_copy(update={"english": "In example III nothing changes."})
    assert judge(told, ADAPTERS[told.kind](told)).verdict == "untested"
    told = entry("text.13.K_2").model_copy(update={"ranges": (r"k=2r-r_0+1, \dots, i",)})
    assert judge(told, ADAPTERS[told.kind](told)).verdict == "untested"
