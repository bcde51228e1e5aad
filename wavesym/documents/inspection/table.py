"""The exact table: how large it is, and where in time the outputs may jump or bend."""

from __future__ import annotations

from collections.abc import Iterator

from wavesym.derivation.table import Table
from wavesym.documents.inspection.section import Display, Facts, Listing, Plain, Section
from wavesym.documents.named_table import named_table
from wavesym.errors import CostError, UnservedError
from wavesym.exact.motion import Motion
from wavesym.exact.tables.network_table import NetworkTable, network_table
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import rational

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
