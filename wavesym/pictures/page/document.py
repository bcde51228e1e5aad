"""A scene as one page of HTML: all that a template needs, computed once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import groupby

from flint import fmpq

from wavesym import __version__
from wavesym.errors import CostError, ToleranceError, WavesymError
from wavesym.exact.contacts.events import events
from wavesym.exact.joints.fronts import has_more_fronts
from wavesym.mechanics.event import LAW_OF
from wavesym.mechanics.model import Model
from wavesym.mechanics.probe import Probe
from wavesym.numbers.doubles import nearest, rational
from wavesym.pictures.groups import load_panel, notes, panels
from wavesym.pictures.histories import Histories, History, drawable, histories
from wavesym.pictures.line_histories import LineHistories, chain_outputs, line_histories
from wavesym.pictures.loads import load_histories
from wavesym.pictures.naming import heading, in_readable_units, with_titles
from wavesym.pictures.page.crossings import crossings
from wavesym.pictures.page.headline import Figure, first_modes, headline, neglected_effects, storeys
from wavesym.pictures.page.load_spectrum import floor_spectrum, load_spectrum
from wavesym.pictures.page.motion import Motion, motion
from wavesym.pictures.page.page_tables import PageTable, advice_table, extremes_table
from wavesym.pictures.page.places import along_pictures, maps
from wavesym.pictures.page.plots import PagePicture, panel, picture
from wavesym.pictures.page.small import first_rows, first_text, fitting
from wavesym.pictures.page.structure import structure
from wavesym.pictures.timescale import Timescale, timescale
from wavesym.pictures.units import unit_text
from wavesym.programs.program import Program
from wavesym.rendering import render
from wavesym.results.summary import Summary, summary_and_program
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import drifts
from wavesym.scene.shown_text import shown_text

_OUTPUTS = 48  # that are drawn
_VERTICES = 60_000  # of all curves together: what keeps the page small
_COLUMNS = (300, 1200)  # of a picture of histories, at least and at most
_LOADS = 8
_PIECES = 2_000_000  # of all outputs along a chain with contacts: tables of more are refused, after seconds
_SHOWN = fmpq(1, 10**5)  # a tenth of the last figure of the page
_FEW = 8  # outputs beside those along the chain, without which these cost hardly less


@dataclass(frozen=True)
class Report:
    """What the template shows."""

    name: str
    project: str
    credit: str
    headline: tuple[Figure, ...]
    storeys: PageTable
    neglected_effects: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]
    structure: PagePicture
    spectrum: PagePicture | None
    floor_spectrum: PagePicture | None
    motion: Motion | None
    histories: tuple[PagePicture, ...]
    notes: tuple[str, ...]
    until: str
    time: str
    columns: int
    extremes: PageTable
    advice: PageTable
    maps: tuple[PagePicture, ...]
    line_pictures: tuple[PagePicture, ...]
    refusal: str
    scene: str
    command: str
    version: str
    sha256: str


def page(scene: Scene) -> str:
    """The page of a scene, with the text it was read from. CostError, ToleranceError as for its histories."""
    model = with_titles(lower(scene))
    model.network.refuse_rodless("a report", "take `plot` and `summary`")
    model = _followed_everywhere(model, chain_outputs(scene, model))
    drawn = model.watching(_fair(model))
    columns = min(max(_VERTICES // (3 * len(drawn.probes)), _COLUMNS[0]), _COLUMNS[1])
    return fitting(
        _report(scene, model, drawn, columns),
        lambda report: render("html/report.html.j2", report=report),
        columns,
    )


def _followed_everywhere(model: Model, placed: Model) -> Model:
    """The same whose contacts are followed once, as all pictures need, where that can be had."""
    if not model.network.corners or has_more_fronts(placed, _PIECES // len(placed.probes)):
        return model
    everywhere = model.following(placed.probes)
    try:
        events(everywhere)
    except WavesymError:
        return model
    return everywhere


def _report(scene: Scene, model: Model, drawn: Model, most: int) -> Callable[[int], Report]:
    """All of it, computed once, whose curves may be drawn with fewer columns than `most`."""
    scale, until = timescale(model), nearest(model.until)
    summary, searched = _summary(model, with_titles(model.watching(drifts(scene))).probes)
    drawn_by, refusal = (searched, None) if searched else _program_of_all(drawn, chain_outputs(scene, model))
    made = histories(drawn, most, drawn_by)
    made = replace(made, outputs=in_readable_units(made.outputs))
    loads = in_readable_units(load_histories(model)[:_LOADS])
    stack = [load_panel(loads, 1.0)] if loads else []
    stack += [each for each in panels(made) if each.histories]
    lines, vibrations = scene.system.lines, first_modes(scene)
    periods = [row.period for row in vibrations if row.period]
    found, refused = _line_pictures(scene, model, None if searched else drawn_by, refusal)
    structured = structure(model, lines)
    block = scene.title_block
    title = f"The structure of {heading(model.name)}"
    report = Report(
        name=model.name,
        project=(block and block.project) or heading(model.name),
        credit=block.credit if block else "",
        headline=tuple(headline(scene, model, summary, found, loads, vibrations)),
        storeys=storeys(scene, found, scale),
        neglected_effects=tuple(filter(None, neglected_effects(model))),
        facts=tuple(_facts(model, made, found, loads, scale)),
        structure=PagePicture(
            title,
            picture(
                "structure",
                title,
                structured.description,
                structured.height,
                structured.markup,
                is_upright=structured.is_upright,
            ),
        ),
        spectrum=load_spectrum(model, loads, periods, scale),
        floor_spectrum=floor_spectrum(model, made.program, periods, scale),
        motion=motion(model, found, scale),
        histories=(),
        notes=tuple(f"{note[:1].upper()}{note[1:]}" for note in (*_missing_outputs(model, drawn), *notes(made))),
        until=repr(until * scale.per_tau),
        time=scale.unit,
        columns=most,
        extremes=first_rows(extremes_table(model, summary, scale)),
        advice=first_rows(advice_table(model, searched)),
        maps=tuple(crossings(model, lines, scene.scale) or maps(model, found, scale)),
        line_pictures=tuple(along_pictures(model, found, scale)),
        refusal=refused,
        scene=first_text(shown_text(scene.text)),
        command=f"wavesym report {model.name}.toml -o {model.name}.html",
        version=__version__,
        sha256=model.labels.sha256,
    )

    def with_columns(columns: int) -> Report:
        curves = (
            panel(f"history-{k}", each, columns, until, scale, last=k == len(stack) - 1) for k, each in enumerate(stack)
        )
        note = f"Curves have {columns} columns of time, not {most}, so that the page stays small"
        notes = (*report.notes, *[note] * (columns < most))
        return replace(report, histories=tuple(curves), columns=columns, notes=notes)

    return with_columns


def _summary(model: Model, drifts: Sequence[Probe]) -> tuple[Summary | WavesymError, Program | None]:
    """The extremes, and the program that they are of, whose curves are drawn; or why there are none.

    Those of a coarser tolerance, which still is finer than what the page shows, where the scene's cannot be met.
    """
    try:
        return summary_and_program(model, drifts=drifts)
    except ToleranceError as error:
        if error.bound > float(nearest(_SHOWN)):
            return error, None
        with suppress(WavesymError):
            return summary_and_program(model.tolerating(max(model.tolerance, _SHOWN)), drifts=drifts)
        return error, None
    except WavesymError as error:
        return error, None


def _program_of_all(drawn: Model, placed: Model) -> tuple[Program | None, WavesymError | None]:
    """One program for the curves over time and for what happens along the chain; or why there is none for both."""
    names = {probe.name for probe in drawn.probes}
    every = drawn.watching([*drawn.probes, *(each for each in placed.probes if each.name not in names)])
    try:
        if drawn.network.corners and has_more_fronts(every, _PIECES // len(every.probes)):
            raise CostError(
                f"output.until: fronts meet rods so often that {len(every.probes)} outputs along the chain would have "
                f"too many pieces, the limit is {_PIECES} (a shorter horizon, or lengths with a larger common measure, "
                "help)"
            )
        return drawable(every), None
    except WavesymError as error:
        return None, error


def _line_pictures(
    scene: Scene, model: Model, program: Program | None, refusal: WavesymError | None
) -> tuple[tuple[LineHistories, ...], str]:
    """What happens along the chain, or why that is not known; with few other outputs they were refused for that."""
    if refusal is not None and len(model.probes) < _FEW:
        return (), _not_drawn(refusal)
    try:
        return line_histories(scene, model, program), ""
    except WavesymError as error:
        return (), _not_drawn(error)


def _not_drawn(refusal: WavesymError) -> str:
    """Why something is not drawn, in words for whoever reads the page; `plot --kind xt` has those for its author."""
    if isinstance(refusal, ToleranceError | CostError):
        return (
            "Not drawn: what happens between the places of the outputs would take too long to compute for all of this "
            "time. The results above do not depend on it."
        )
    return f"Not drawn: {refusal}"


def _fair(model: Model) -> list[Probe]:
    """The outputs that are drawn: as many of each quantity, or all of them."""
    groups = [list(group) for _, group in groupby(model.probes, key=lambda probe: probe.quantity)]
    each = max(1, _OUTPUTS // len(groups))
    return [probe for group in groups for probe in group[:each]]


def _missing_outputs(model: Model, drawn: Model) -> list[str]:
    missing = len(model.probes) - len(drawn.probes)
    return (
        [f"{missing} of {len(model.probes)} outputs are not drawn; their extremes are in the table"] if missing else []
    )


def _facts(
    model: Model, made: Histories, found: Sequence[LineHistories], loads: Sequence[History], scale: Timescale
) -> Iterator[tuple[str, str]]:
    """What there is to know at first sight, each under a word."""
    network, program = model.network, made.program
    assert program is not None  # histories have one
    yield "System", ", ".join([model.labels.system["type"], *_system_choices(model)])
    rods, bodies = len(network.bars), len([point for point in network.points if point.mass])
    yield "Modelled", f"{_count(rods, 'elastic rod')}, {_count(bodies, 'rigid body', 'rigid bodies')}"
    if model.damping is not None:
        yield "Damping", model.damping.in_words
    if load_texts := _loads(model, loads):
        yield "Loads", load_texts
    yield "Horizon", scale.format(nearest(model.until))
    if model.clock is not None:
        yield "One tau", f"{nearest(model.clock.seconds):.6g} s: the time that a wave takes to cross the first rod"
    yield "Computed by", program.provenance.reason.rpartition("; ")[2]
    yield (
        "Bound",
        f"{_bound('a curve over time', program, model)} Whether the model is the structure is another question.",
    )
    if found and found[0].program.error_bound != program.error_bound:
        yield "Bound over place", _bound("what is drawn over place", found[0].program, model)
    for end in made.contacts:
        yield (
            "Contact",
            f"that at x = {end.x} opens at {scale.format(end.double)}; "
            "what that reaches is drawn as if it stayed closed",
        )
    for number in network.corners:
        place = network.links[number].place
        if own := [each for each in program.provenance.events or () if each.x == place]:
            yield (
                LAW_OF[own[0].kind].capitalize(),
                f"at x = {place}: " + ", ".join(f"{each.kind} at {scale.format(each.double)}" for each in own),
            )


def _loads(model: Model, loads: Sequence[History]) -> str:
    """As the scene says them; with units, whose exact numbers nobody can read, by their sizes."""
    if model.clock is None:
        return "; ".join(map(": ".join, zip(model.labels.load_names, model.labels.loads, strict=True)))
    values = ((load, load.points[:, 1]) for load in loads)
    return "; ".join(
        f"{each.name}, from {min(v):.4g} to {max(v):.4g} {unit_text(each.output.unit)}" for each, v in values
    )


def _system_choices(model: Model) -> list[str]:
    return [f"{key} = {value}" for key, value in model.labels.system.items() if key in ("base", "contacts")]


def _count(number: int, one: str, many: str = "") -> str:
    return f"{number} {one if number == 1 else many or one + 's'}"


def _bound(what: str, program: Program, model: Model) -> str:
    """How far from the truth is what is drawn, and whether that meets the tolerance that was asked for."""
    if program.proved:
        known = (
            f"proved: at no time is {what} farther from the exact solution of this model than this part of its own "
            "largest value."
        )
    else:
        known = (
            "an estimate that is not proved: so far from the exact solution of this model, in parts of its own largest "
            f"value, {what} may be."
        )
    met = rational(program.error_bound) <= model.tolerance
    coarse = (
        f" That is more than the tolerance of the scene, {nearest(model.tolerance):g}, but less than a picture shows."
    )
    return f"{program.error_bound:.2g}, {known}{'' if met else coarse}"
