"""`wavesym inspect`: what one stage of the compiler makes of a scene, or a summary of all, as text or JSON.

The scene as the user said it, every number exact; the table by its size, and where outputs may jump or bend.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from wavesym.derivation.table import Table
from wavesym.documents.inspection.laws import joints, law_sections, unsupported_facts
from wavesym.documents.inspection.model import light_cone, model_sections, outputs, part_counts
from wavesym.documents.inspection.program import choice, contacts, program_sections, stream, variants
from wavesym.documents.inspection.section import Display, Facts, Listing, Plain, Section, plain
from wavesym.documents.inspection.text import section_lines, value_text
from wavesym.documents.inspection.units import in_units
from wavesym.documents.named_table import named_table
from wavesym.errors import CostError, UnservedError
from wavesym.exact.motion import Motion
from wavesym.exact.tables.network_table import NetworkTable, network_table
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import rational
from wavesym.programs.choice import attempts
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import named_chain, sources
from wavesym.scene.physical.scene import PhysicalScene

SUMMARY = "summary"
_STAGES: Mapping[str, Callable[[Scene], Iterable[Section]]] = {
    SUMMARY: lambda scene: summary_sections(lower(scene), named_chain(scene), sources(scene), scene.physical),
    "scene": lambda scene: scene_sections(scene),
    "model": lambda scene: model_sections(lower(scene), named_chain(scene)),
    "laws": lambda scene: law_sections(lower(scene), named_chain(scene)),
    "table": lambda scene: table_sections(lower(scene), named_chain(scene)),
    "program": lambda scene: program_sections(lower(scene), sources(scene)),
}


def inspection(scene: Scene, stage: str = SUMMARY, format: str = "text") -> str:
    """A stage ("scene", "model", "laws", "table", "program") or the summary of a scene, as "text" or "json"."""
    return "".join(inspection_lines(scene, stage, format))


def inspection_lines(scene: Scene, stage: str, format: str) -> Iterator[str]:
    """The same as it is known: of text, what the model is before programs are tried."""
    sections = _STAGES[stage](scene)
    if format == "json":
        content = {"name": scene.name, "stage": stage, **{section.key: plain(section) for section in sections}}
        yield json.dumps(content, indent=2, allow_nan=False) + "\n"
        return
    yield from (f"{line}\n" for line in _lines(scene.name, stage, sections))


def _lines(name: str, stage: str, sections: Iterable[Section]) -> Iterator[str]:
    yield f"{name}: {stage}"
    for section in sections:
        yield from section_lines(section)


def scene_sections(scene: Scene) -> Iterator[Section]:
    """The tables of a scene, under its own keys."""
    fields = scene.model_dump(mode="json")
    if fields.get("units"):
        yield Facts("units", "How it counts", fields["units"])
    yield Facts("system", "The chain, as it was said", fields["system"])
    loads = fields.get("load", [])
    names = tuple(dict.fromkeys(name for load in loads for name in load))
    rows = [{name: Display(value, f"{name} = {value_text(value)}") for name, value in load.items()} for load in loads]
    yield Listing("load", "Its loads", rows, names)
    yield Facts("output", "What is wanted", fields["output"])


def summary_sections(
    model: Model, chain: Chain | None, sources: Sequence[str], physical: PhysicalScene | None = None
) -> Iterator[Section]:
    """From the chain to the programs that were tried; loads have these `sources`."""
    yield Facts(
        "system", "The chain, with the parameters that can matter", {**model.labels.system, **_parameters(model, chain)}
    )
    until = Display(str(model.until), model.clock.format(model.until)) if model.clock else str(model.until)
    yield Facts(
        "horizon",
        "How long and how exactly",
        {"until": until, "tau_max": model.horizon(), "tolerance": str(model.tolerance)},
    )
    if physical:
        yield from in_units(physical, model)
    yield light_cone(model)
    yield joints(model)
    yield Listing("loads", "Loads", [{"load": load} for load in model.labels.loads if load], ("load",))
    yield outputs(model)
    tried = attempts(model)
    yield choice(model, tried)
    yield contacts(model)
    yield stream(model, sources)
    yield variants(model, tried)
    if chain is None:
        yield unsupported_facts(model)


def _parameters(model: Model, chain: Chain | None) -> dict[str, Plain]:
    letters = {
        name: {str(i): str(value) for i, value in numbers.items()} for name, numbers in model.letters.items() if numbers
    }
    return {**({"m": chain.m} if chain else {}), **letters, **part_counts(model)}


MOST_COUNTED = 30_000  # coefficients, which take a second or two to make
MOST_SHOWN = 8  # breakpoints of an output
LONGEST = 10_000  # tau; to estimate the size of longer tables takes seconds, too


def table_sections(model: Model, chain: Chain | None) -> Iterator[Section]:
    """The size of the table that `tables` prints, and the breakpoints of every output."""
    try:
        _refuse_long(model)
        made = _table(model, chain)
    except (CostError, UnservedError) as refusal:
        yield Facts("table", "The exact table is not made here", {"refusal": str(refusal)})
    else:
        yield from _sizes(made)
    words = f"Breakpoints: an output may jump or bend at `count` instants; here are the first {MOST_SHOWN}"
    yield Listing("breakpoints", words, list(_breakpoints(model)), ("first", "refusal"))


def _refuse_long(model: Model) -> None:
    if model.until > LONGEST:
        raise CostError(
            f"output.until: a table to tau = {model.horizon():g} is not counted here, the limit is {LONGEST} (a "
            "shorter horizon helps)"
        )


def _table(model: Model, chain: Chain | None) -> Table | NetworkTable:
    model.refuse_damping()
    until = rational(model.horizon())
    if chain is None:
        return network_table(model.network, None, until, most=MOST_COUNTED)
    return named_table(chain, model.network, None, until, most=MOST_COUNTED)


def _sizes(table: Table | NetworkTable) -> Iterator[Section]:
    counts: dict[tuple[str, int | str, str], list[Plain]] = {}
    for row in table.rows():
        count = counts.setdefault((row.function, row.rod, row.source), [0, set()])
        count[0] += 1
        count[1].add(row.rate)
    rows = [
        {
            "function": function.function,
            "rod": (rod := function.rod if isinstance(table, Table) else table.rod(function)),
            "source": source,
            "intervals": len(increments),
            "coefficients": counts.get((function.function, rod, source), [0, ()])[0],
            "rates": [str(rate) for rate in sorted(counts.get((function.function, rod, source), [0, ()])[1])],
        }
        for source, response in table.responses.items()
        for function, increments in sorted(response.items())
    ]
    total: dict[str, Plain] = {"coefficients": sum(row["coefficients"] for row in rows)}
    words = "The exact table: how many coefficients are not 0"
    if isinstance(table, Table):
        total = {"interval": table.interval, **total}
        words = "The exact table: how long an interval is, and how many coefficients are not 0"
    yield Facts("table", words, total)
    yield Listing("functions", "Its wave functions, for each source", rows)


def _breakpoints(model: Model) -> Iterator[dict[str, Plain]]:
    try:
        motion = Motion(model, rational(model.horizon()))
    except (CostError, UnservedError) as refusal:
        for probe in model.probes:
            yield {"name": probe.name, "count": None, "first": Display(None, ""), "refusal": str(refusal)}
        return
    for probe in model.probes:
        starts = motion.starts(probe)
        first = list(map(str, starts[:MOST_SHOWN]))
        yield {"name": probe.name, "count": len(starts), "first": first, "refusal": Display(None, "")}
