"""Ways to what people read: tables of coefficients, derivations, walks, what each stage makes of a scene."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from wavesym.documents.tables import symbolic_lines, table_lines
from wavesym.errors import UnservedError
from wavesym.exact.tables.network_table import NetworkTable, network_table
from wavesym.exact.tables.rate_letters import in_rates
from wavesym.exact.tables.symbolic_cost import refuse_costly
from wavesym.exact.tables.table import Row, Table, full_table
from wavesym.mechanics.symbolic import generic, symbolic
from wavesym.numbers.doubles import fraction, rational
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import named_chain

if TYPE_CHECKING:
    from wavesym.mechanics.chain import Chain


MOST_FACTORED = 100_000  # coefficients of a symbolic table; half a millisecond each, however small


def tables(scene: Scene, intervals: int | None = None) -> list[Row]:
    """The rows of the coefficient table, exact: `intervals` of every function, or those the horizon needs.

    A row is one term: in the interval that it names, the derivative of the wave function gains
    value * exp(-rate * w) * w**power. Of a chain that is written out `interval` is the tau at which the wave leaves its
    end of the rod. UnservedError for a chain that has contacts, or a node whose polynomial does not split.

    >>> import wavesym
    >>> row = wavesym.tables(wavesym.Scene.from_toml("building_m2"), intervals=1)[0]
    >>> row.function, row.rod, row.source, row.interval, row.rate, row.power, row.value
    ('f', 1, 'a', 1, Fraction(0, 1), 0, Fraction(-4, 1))
    """
    rows = table(scene, intervals).rows()
    return [
        row._replace(
            interval=row.interval if isinstance(row.interval, int) else fraction(row.interval),
            rate=fraction(row.rate),
            value=fraction(row.value),
        )
        for row in rows
    ]


def table(scene: Scene, intervals: int | None = None) -> Table | NetworkTable:
    """The unit responses of all sources of the scene's system."""
    model = lower(scene)
    model.refuse_damping()
    until = rational(model.horizon())
    chain = named_chain(scene)
    return full_table(chain, intervals, until) if chain else network_table(model.network, intervals, until)


def tables_text(scene: Scene, intervals: int | None, format: str) -> Iterator[str]:
    """The table as csv, json or latex, line by line."""
    return table_lines(table(scene, intervals), scene.name, format)


def symbolic_tables_text(scene: Scene, intervals: int | None, format: str) -> tuple[list[str], Iterator[str]]:
    """The table as rational functions of the parameters, csv or json, after what the symbols stand for, line by line.

    Parameters and rates that are equal in the scene are equal in the table. CostError where it would be absurd.
    """
    model = lower(scene)
    model.refuse_damping()
    symbols = in_rates(symbolic(_named(scene, "--symbolic", "tables")))
    until = rational(model.horizon())
    refuse_costly(symbols.chain, intervals, until)
    made = full_table(symbols.chain, intervals, until, most=MOST_FACTORED)
    merged = [f"{name} = {ratio}" for name, ratio in symbols.meaning.items() if str(ratio) != name]
    return merged, symbolic_lines(made, symbols, scene.name, format)


def inspect(scene: Scene, stage: str | None = None, format: str = "text") -> str:
    """What a stage makes of a scene, or a summary of all of them, as text or json; refusals are part of it.

    `stage` is "scene", "model", "laws", "table" or "program".
    """
    from wavesym.documents.inspection.document import SUMMARY, inspection

    return inspection(scene, stage or SUMMARY, format)


def derive(source: str | Scene, m: int | None, format: str = "text") -> str:
    """The derivation of "collision", "drive" or "building" (both bases), or of a scene, as text, latex or json.

    With m, every line is written out; a scene has its own. Of a chain that is written out it is the law of each kind of
    node. WavesymError for an m that the system does not have.
    """
    from wavesym.documents.derivation.document import derivation, network_derivation, scene_derivation

    if isinstance(source, str):
        return derivation(source, m, format)
    model = lower(source)
    model.refuse_damping()
    chain = named_chain(source)
    return scene_derivation(source.name, symbolic(chain), format) if chain else network_derivation(model, format)


def walks(source: str | Scene, m: int | None, intervals: int, format: str = "text") -> str:
    """The walk polynomials of `derive`'s systems with m elastic elements, or of a scene, as text, latex or json.

    WavesymError for an m that the system does not have; CostError where the polynomials would be absurd.
    """
    from wavesym.documents.derivation.statement import systems
    from wavesym.documents.walks import walk_polynomials

    if isinstance(source, str):
        assert m is not None  # polynomials are those of one chain
        return walk_polynomials((generic(system, m) for system in systems(source, m)), intervals, format)
    return walk_polynomials([symbolic(_named(source, "--walks", "derive"))], intervals, format)


def _named(scene: Scene, option: str, command: str) -> Chain:
    """The chain as the paper has it. UnservedError where it has none."""
    model, chain = lower(scene), named_chain(scene)
    model.refuse_damping()
    if chain is None:
        raise UnservedError(
            f"system.type: {model.labels.type} given with {option}, collision, drive or building expected "
            f"(`{command}` without {option} serves a chain)"
        )
    return chain
