"""Section 5 and the summaries: what their strings say is what is judged."""

from __future__ import annotations

import numpy as np
import pytest

from tests.papers.falsified import ENTRIES, judged
from wavesym.exact.reference import Reference
from wavesym.papers.pielorz1979.figure_scenes import PLOTTED, figure, loads
from wavesym.scene import lower


@pytest.mark.parametrize(
    ("id", "word", "other"),
    [
        ("text.16", "slightly", "considerably"),
        ("text.16", "x = 1", "x = 3"),
        ("text.18", "rise at first and fall later", "fall at first and rise later"),
        ("text.20", "x = 3", "x = 2"),
        ("text.21", "at the end of", "throughout"),
        ("text.23", "M_1 = M_2", "M_1 = -M_2"),
        ("text.16", "differs", "differ"),
        ("Fig.6.caption", "0.2", "0.3"),
        ("Fig.6.caption", "m = 4", "m = 6"),
        ("Fig.7.caption", r"\gamma_2", r"\gamma_3"),
        ("summary.en.1", "m/2", "m"),
    ],
)
def test_a_false_sentence_is_seen(id: str, word: str, other: str) -> None:
    said = ENTRIES[id].statement
    assert word in said
    place = "english" if ENTRIES[id].english else "printed"
    assert judged(id, **{place: said.replace(word, other)}).verdict == "untested"


@pytest.mark.parametrize(
    ("id", "text"),
    [
        ("text.29", r"\tau \approx 8.91"),
        ("text.29", r"\tau \approx 8.9018"),
        ("text.29", r"t \approx 8.90"),
        ("text.25", "the larger strains occur at x = 0.5, not at x = 1.5, of the loads tried under these: step"),
        ("text.25", "the larger strains occur at x = 0.5, not at x = 1.5, of the loads tried under these: storm"),
        (
            "text.25",
            "the smaller strains occur at x = 0.5, not at x = 1.5, "
            "of the loads tried under these: one slow swing; step",
        ),
    ],
)
def test_a_false_correction_is_seen(id: str, text: str) -> None:
    assert judged(id, slip={"correction": text}).verdict == "untested"


@pytest.mark.parametrize(
    ("id", "range_"), [("summary.en.4", "m = 6"), ("Fig.7.bodies", "m = 0"), ("Fig.8.floors", "m = 3")]
)
def test_a_false_range_is_seen(id: str, range_: str) -> None:
    assert judged(id, ranges=(range_,)).verdict == "untested"


@pytest.mark.parametrize("id", ["text.22", "text.24", "text.25", "text.26", "text.27", "text.28"])
def test_every_load_is_told_with_its_outcome(id: str) -> None:
    told = next(part for part in judged(id).evidence if "; false under " in part)
    true, _, false = told.partition("; false under ")
    slip = ENTRIES[id].slip
    assert slip is not None
    named = slip.correction.partition("under these: ")[2].split("; ")
    for load in loads(ENTRIES[id].subject["figure"]):
        assert f"{load.name} (" in (true if load.name in named else false)


def test_a_load_is_the_sum_of_its_pieces() -> None:
    """Shifted and added curves of the exact tables are those of the scene with the whole load, by waves in balls."""
    for number, name in ((7, "stairs down"), (8, "fast zigzag")):
        (load,) = (load for load in loads(number) if load.name == name)
        scene = figure(number)
        reference = Reference(lower(scene.scene(load)))
        values = reference.values(scene.instants.tolist())
        for output, row in zip(reference.model.probes, values, strict=True):
            quantity, place = output.name.split("@")
            assert place in PLOTTED[number][quantity]
            assert np.allclose(scene.curve(load, quantity, place), row, rtol=0, atol=1e-12)


def test_a_counterexample_is_a_scene() -> None:
    record = judged("text.22")
    assert record.counterexample is not None
    assert record.counterexample.example is not None
    example = record.counterexample.example()
    assert 'times = ["0", "1/2"]' in example.scene
    assert "SCENE" in example.command
    assert "strain@0" in example.look
