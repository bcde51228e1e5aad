"""Section 5: the statements about Figs. 6, 7 and 8, on the exact motion of what their captions describe.

The load curves of Figs. 7 and 8 are not in the text: a statement is tried under several loads, and is either said of
all of them, or of those only that it names. A caption is judged by what is said of its figure. The patterns of the
sentences are in sentences.toml.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from functools import cache, partial
from typing import Any

import numpy as np
from flint import fmpq

from wavesym.papers.entries import PaperEntry
from wavesym.papers.evaluation import MeaninglessError, Scope
from wavesym.papers.pielorz1979.chains import scene_text
from wavesym.papers.pielorz1979.figure_scenes import (
    PLOTTED,
    SAMPLES,
    SENSES,
    FigureScene,
    TriedLoad,
    contact_end,
    figure,
    loads,
    read_caption,
)
from wavesym.papers.pielorz1979.measures import BOUNDS, MEASURES, Finding, Measure
from wavesym.papers.pielorz1979.transcript import entries, patterns
from wavesym.papers.reader import UnreadableError, read_formula
from wavesym.papers.record import Case, NoValue, Reproduction, Sentence, Test, case, format_value
from wavesym.papers.sentences import LIST, SentenceReader
from wavesym.papers.tree import Number, Relation, Tree, latex
from wavesym.scene import lower
from wavesym.scene.lowering import named_chain

NEAR = 0.01
"""How far a time that is read off a figure may be out, as a part of itself."""
ONLY = ", of the loads tried under these: "
READERS = {
    number: SentenceReader(
        replace(pattern, list_opening=ONLY, list_words=tuple(load.name for load in loads(number)))
        for pattern in patterns()
        if pattern.data.get("figure") == number
    )
    for number in PLOTTED
}
"""What reads the sentences about each figure; the loads of which one is said alone stand after it."""


def statements(number: int) -> dict[str, Sentence]:
    """What is printed of a figure, by id."""
    return {entry.id: READERS[number].sentence(entry.statement) for entry in _figure_entries(number, "figure")}


def _pattern_data(sentence: Sentence) -> Mapping[str, Any]:
    return next(pattern.data for pattern in patterns() if pattern.name == sentence.pattern)


def _measure(sentence: Sentence) -> Measure:
    return MEASURES[_pattern_data(sentence)["measure"]]


def _bound(sentence: Sentence) -> tuple[str, Callable[[float], bool]]:
    """When what is measured is as a sentence says, in words and as a test."""
    bound = _measure(sentence).bound
    return BOUNDS[sentence.words.get(bound, bound)]


def meaning(sentence: Sentence) -> str:
    """What a sentence says of a measure, in words."""
    words: str = _pattern_data(sentence).get("meaning", _measure(sentence).meaning)
    return words.format(**{**sentence.words, "bound": _bound(sentence)[0]})


def loads_tried(number: int, sentence: Sentence) -> tuple[TriedLoad, ...]:
    """The loads that a sentence is tried under."""
    return loads(number, SENSES[sentence.words.get("sense", "M_1 = M_2")])


def finding(scene: FigureScene, load: TriedLoad, sentence: Sentence) -> Finding:
    """What is measured under a load. MeaninglessError where there is nothing to measure."""
    (drawn,) = (drawn for drawn in loads_tried(scene.figure, sentence) if drawn.name == load.name)
    words = {place: word for place, word in sentence.words.items() if place != "listed"}
    return _find(scene, drawn, Sentence(sentence.pattern, words))


@cache
def _find(scene: FigureScene, load: TriedLoad, sentence: Sentence) -> Finding:
    return _measure(sentence).find(sentence.words, partial(scene.curve, load))


def is_true(scene: FigureScene, load: TriedLoad, sentence: Sentence) -> bool:
    """Whether what a sentence says is so under a load. MeaninglessError."""
    return _bound(sentence)[1](finding(scene, load, sentence).value)


def findings(number: int, sentence: Sentence) -> list[tuple[TriedLoad, Finding]]:
    """What is measured under each load."""
    return [(load, finding(figure(number), load, sentence)) for load in loads_tried(number, sentence)]


def _figure_entries(number: int, kind: str) -> Iterable[PaperEntry]:
    return (entry for entry in entries().values() if entry.subject.get("figure") == number and entry.kind == kind)


def figure_statement(entry: PaperEntry) -> Test:
    """A sentence about a figure."""
    number = entry.subject["figure"]
    base = " (the base of (4.5))" if number == 8 else ""
    return Test(
        f"the exact motion of the scene of the caption{base}, at {SAMPLES} instants",
        lambda reading: _cases(figure(number), reading.formula),
        READERS[number].read,
        READERS[number].faults,
        variation="loads",
        observation=lambda: _observation(figure(number), entry),
    )


def _cases(scene: FigureScene, sentence: Sentence) -> Iterator[Case]:
    listed = sentence.words.get("listed")
    for load in loads_tried(scene.figure, sentence):
        claimed = listed is None or load.name in listed.split(LIST)
        try:
            found, is_so = finding(scene, load, sentence), is_true(scene, load, sentence)
        except MeaninglessError as error:
            yield Case({"load": load.name}, claimed, NoValue(str(error)))
            continue
        at = {"load": load.name, "measured": found.value, "said": meaning(sentence)}
        yield Case(at, claimed, is_so, example=partial(_example, scene, load, found))


def _observation(scene: FigureScene, entry: PaperEntry) -> str:
    """Every load with its outcome."""
    try:
        sentence = READERS[scene.figure].sentence(entry.statement)
    except UnreadableError as error:
        return f"NoValue was measured: {error}."
    parts = [f"Measured ({meaning(sentence)}): {_outcomes(scene, sentence)}."]
    for sense in SENSES if "sense" in sentence.words else ():
        if sense != sentence.words["sense"]:
            other = Sentence(sentence.pattern, {**sentence.words, "sense": sense})
            parts.append(f"With {sense}: {_outcomes(scene, other)}.")
    return " ".join(parts)


def _outcomes(scene: FigureScene, sentence: Sentence) -> str:
    outcomes: dict[bool, list[str]] = {True: [], False: []}
    for load in loads_tried(scene.figure, sentence):
        outcomes[is_true(scene, load, sentence)].append(
            f"{load.name} ({format_value(finding(scene, load, sentence).value)})"
        )
    return "; ".join(f"{'true' if so else 'false'} under {', '.join(names)}" for so, names in outcomes.items() if names)


def _example(scene: FigureScene, load: TriedLoad, found: Finding) -> Reproduction:
    """The scene of a case, and where to look: the values of its curves at the spots."""
    points = dict.fromkeys(point for spot in found.spots for point in spot)
    outputs: dict[str, list[str]] = {}
    for quantity, place in dict.fromkeys((point.quantity, point.place) for point in points):
        outputs.setdefault(quantity, []).append(place)
    look = ", ".join(
        f"{point.output} = {scene.curve(load, point.quantity, point.place)[point.instant]:.4g}"
        f" at tau = {scene.instants[point.instant]:.6g}"
        for point in points
    )
    return _reproduction(scene, load, outputs or PLOTTED[scene.figure], look or "fewer than three swings")


def _reproduction(scene: FigureScene, load: TriedLoad, outputs: Mapping[str, Sequence[str]], look: str) -> Reproduction:
    described = scene.scene(load)
    chain = named_chain(described)
    assert chain is not None  # as the paper has it
    text = scene_text(chain, dict(load.pieces), lower(described).until, outputs)
    return Reproduction(text, f"wavesym run SCENE --samples {SAMPLES}", look)


def caption_of_figure(entry: PaperEntry) -> Test:
    """The quantities of a figure: what is said of it must be true of the scene that they describe."""
    number = entry.subject["figure"]
    return Test(
        "what section 5 says of the figure, under some load, on the exact motion of the scene described here",
        lambda reading: _described_cases(number, reading.formula),
    )


def _described_cases(number: int, formula: Tree) -> Iterator[Case]:
    """Each sentence, as printed, under some load at least: the load curves are not in the text."""
    scene = read_caption(number, formula)

    def is_near(read_off: float) -> bool:
        return abs(float(contact_end(scene)) - read_off) <= NEAR * read_off

    def under_some_load(printed: str) -> bool:
        try:
            sentence = READERS[number].sentence(printed)
        except UnreadableError as error:
            raise MeaninglessError(str(error)) from None
        return any(is_true(scene, load, sentence) for load in loads_tried(number, sentence))

    for entry in _figure_entries(number, "contact"):
        yield case({"said": entry.printed, "allowed": f"{NEAR:.0%}"}, partial(is_near, printed_end(entry)), True)
    for entry in _figure_entries(number, "figure"):
        yield case({"said": entry.statement}, partial(under_some_load, entry.statement), True)


def end_of_contact(entry: PaperEntry) -> Test:
    """When the contact of Fig. 6 opens: to as many places as are printed."""
    return Test("when the contact at x = 2 opens, in ball arithmetic", lambda reading: _end_cases(reading.formula))


def printed_end(entry: PaperEntry) -> float:
    """The time that a record of this kind gives."""
    return float(_approximate(read_formula(entry.printed))[1].digits)


def _approximate(formula: Tree) -> tuple[Tree, Number]:
    match formula:
        case Relation((left, Number() as number), (r"\approx",)):
            return left, number
    raise MeaninglessError(f"{latex(formula)} gives no number")


def _end_cases(formula: Tree) -> Iterator[Case]:
    left, number = _approximate(formula)
    exact = Fraction(contact_end(figure(6)))
    claim = Scope({r"\tau": fmpq(exact.numerator, exact.denominator)}).value(left)
    places = len(number.digits.partition(".")[2])
    opens = f"{Decimal(int(claim.numer())) / Decimal(int(claim.denom())):.{places}f}"
    yield Case({"x": 2, "places": places}, number.digits, opens, example=partial(_opening, float(number.digits)))


def _opening(read_off: float) -> Reproduction:
    """The strain of the contact, until it is 0 again."""
    (load,) = loads(6)
    scene = figure(6)
    k = min(int(np.searchsorted(scene.instants, read_off)), SAMPLES - 1)
    then, last = (f"{scene.instants[at]:.6g}" for at in (k, -1))
    look = f"strain@2 = {scene.curve(load, 'strain', '2')[k]:.4g} at tau = {then}; it is 0 again at {last}, not before"
    return _reproduction(scene, load, {"strain": ("2",)}, look)
