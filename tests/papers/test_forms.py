"""(4.9), (4.10), (4.12): the strings are what is run against the motion."""

import json
import math
import re
from collections.abc import Sequence
from fractions import Fraction

import pytest

import wavesym
from wavesym import api
from wavesym.papers.pielorz1979.paper import ADAPTERS
from wavesym.papers.pielorz1979.transcript import entry
from wavesym.papers.record import judge


def verdict(id: str, **update: object) -> str:
    changed = entry(id).model_copy(update=update)
    return judge(changed, ADAPTERS[changed.kind](changed)).verdict


def corrected(id: str, *edits: tuple[str, str], ranges: Sequence[str] | None = None) -> str:
    """The verdict where the correction says something else."""
    slip = entry(id).slip
    assert slip
    text = slip.correction
    for before, after in edits:
        assert before in text
        text = text.replace(before, after)
    return verdict(id, slip=slip.model_copy(update={"correction": text, "ranges": ranges}))


@pytest.mark.quick(3)
@pytest.mark.parametrize(
    ("id", "before", "after"),
    [
        ("(4.9)", "E(K_{j, s}/2)", "K_{j, s}"),
        ("(4.10)", "H(w)", ""),
        ("(4.12)", "F_0^{k, i, n+1}(z-2n-\\tau_k)", "F_0^{k, i, n+1}"),
        ("(4.12)", "e^{-\\kappa_m", "e^{-2\\kappa_m"),
        ("(4.12)", "{m_1}", "{m_1-1}"),
    ],
)
def test_a_form_that_becomes_otherwise_wrong_is_seen(id: str, before: str, after: str) -> None:
    assert corrected(id, (before, after)) == "untested"


@pytest.mark.parametrize("id", ["(4.9)", "(4.12)"])
@pytest.mark.parametrize(
    "ranges", [("n = 1, 2, \\dots",), ("n = 0, 2, \\dots",), ("n = -1, 0, \\dots",), ("i = 1, 2",)]
)
def test_the_numbers_of_a_form_are_judged(id: str, ranges: tuple[str, ...]) -> None:
    assert verdict(id, inferred_ranges=ranges) == "untested"


@pytest.mark.parametrize(
    ("id", "printed", "expected"),
    [
        ("(4.10).L_0", "L_1=0", "untested"),
        ("(4.11).r_0", r"r_0 = \begin{cases} 0 & i = 2, 4, \dots \\ 1 & i = 1, 3, \dots \end{cases}", "untested"),
        ("(4.11).r_1", r"r_1 = \begin{cases} 0 & i = 2, 4, \dots \\ 1 & i = 3, 5, \dots \end{cases}", "untested"),
        ("(4.11).2", r"\gamma_{m+1} = \kappa_m \frac{J_{m+1}}{J_m}", "untested"),
        ("(4.12).z", r"z \in (2n, 2n+1)", "untested"),
        ("(4.12).z", r"z \in (2n, 2n+2 \rangle", "untested"),
        ("(4.10).z", r"z \in (d, d+1)", "untested"),
    ],
)
def test_definitions_and_intervals_are_what_they_say(id: str, printed: str, expected: str) -> None:
    assert verdict(id, printed=printed, equivalent=()) == expected


def test_a_range_of_rates_that_is_too_long_or_short_is_a_verdict() -> None:
    for last in ("m+1", "m-1"):
        assert verdict("(4.11).1", ranges=(rf"i=2, 3, \dots, {last}",)) == "untested"
    assert verdict("(4.11).1") == "misprint"


def test_what_to_look_at_gives_the_numbers_of_a_counterexample() -> None:
    """By the rule that it states, over the table of its scene: with what is left out, and without."""
    text, _ = api.verify_published("json", ["(4.10).H"], reproduce=True)
    (record,) = json.loads(text)
    look = re.search(
        r"^(\w) of rod (\d+), interval (\d+): .* at z = \S+ .* w = (\S+) - t,", record["reproduce"]["look"]
    )
    said = re.search(r"printed gives (\S+); it should be (\S+)\.", record["counterexample"])
    assert look
    assert said
    printed, right = said.groups()
    letter, rod, number, since = look.groups()
    assert number == "1"
    scene = wavesym.Scene.from_toml(record["reproduce"]["scene"])
    steps = [(f"M{load.body}", *each) for load in scene.load for each in zip(load.times, load.steps, strict=True)]
    added = [
        (w := float(Fraction(since) - time), float(size * row.value) * math.exp(-float(row.rate) * w) * w**row.power)
        for row in wavesym.tables(scene, 1)
        if (row.function, str(row.rod)) == (letter, rod)
        for source, time, size in steps
        if source == row.source
    ]
    assert float(printed) == pytest.approx(sum(value for _, value in added), rel=1e-5)
    assert float(right) == pytest.approx(sum(value for w, value in added if w >= 0), abs=1e-12)
