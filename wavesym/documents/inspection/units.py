"""A scene in units: what its waves and periods are in seconds, and how far its model is the structure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from flint import arb

from wavesym.documents.inspection.section import Display, Facts, Listing, Plain, Section
from wavesym.errors import CostError, UnservedError, WavesymError
from wavesym.exact.modes.frequencies import frequencies
from wavesym.fields.numbers import decimal_text
from wavesym.fields.rounding import DIGITS
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import midpoint
from wavesym.results.modes import modes
from wavesym.scene.physical.scene import PhysicalScene
from wavesym.systems.elastic import Rods

_PERIODS = 5
_DAMPED = 3  # of those beside dashpots, which take longer
_MOST_RODS = 40  # beside dashpots: a second or two
_RIGID = 1  # modes of a chain that nothing holds
_KAPPA = (1e-4, 10.0)
_SLENDER = 5  # times as long as wide: where a rod begins to be one
_NAMES = {"longitudinal": ("mass", "m"), "shear": ("mass", "m"), "torsional": ("moment of inertia", "rad")}


def in_units(physical: PhysicalScene, model: Model) -> Iterator[Section]:
    """The sections of a scene with [units]."""
    scale, clock = physical.scale, model.clock
    assert clock is not None  # a scene in units has one
    rods, seconds = scale.rods, float(scale.seconds)
    first = rods.first
    periods, why = _periods(model, seconds)
    limit = 1 / (2 * seconds * float(max(rods.ratios))) if rods.all else None
    framed = physical.fields_in_units["system"]["type"] == "building"
    above = "above it a rod is not the columns that it stands for" if framed else "from it on rods swing by themselves"
    yield Facts(
        "units",
        "In units",
        {
            "kind": scale.kind,
            "seconds_per_tau": Display(
                str(scale.seconds),
                f"{_si(seconds, 's')}, {_exact_delay(rods)}" if rods.all else "1 s, as there are no rods",
            ),
            "c": Display(float(first.length) / seconds, f"{float(first.length) / seconds:.6g} m/s, of the first rod")
            if rods.all
            else None,
            "kappa": Display([float(k) for k in physical.kappa], _several(sorted({float(k) for k in physical.kappa}))),
            "periods": Display(
                periods, why or ", ".join(f"T{k} = {_si(period, 's')}" for k, period in enumerate(periods, 1))
            ),
            "horizon": Display(
                {"tau": model.horizon(), "time": clock.time(model.until), "unit": clock.unit},
                f"{model.horizon():.6g} tau, {clock.format(model.until)}",
            ),
            "physics_up_to": None if limit is None else Display(limit, f"{limit:.4g} Hz = c/(2 l): {above}"),
        },
    )
    if not rods.alike:
        yield _rods(physical, model)
    found = [*remarks(physical), *model.labels.notes]
    yield Listing("remarks", "Remarks", [{"remark": line} for line in found], ("remark",))


def _exact_delay(rods: Rods) -> str:
    """What l/c of the first rod is taken to be."""
    if rods.seconds**2 == rods.first.delay_squared:
        return f"l/c: {rods.seconds} s"
    return f"l/c rounded to {DIGITS} digits: {decimal_text(rods.seconds)} s"


def _periods(model: Model, seconds: float) -> tuple[list[float], str]:
    """The longest periods in s; in words what else is to be said of them, or why they are not known."""
    network = model.network_as_written
    if network.loses:
        return _damped_periods(replace(model, network=network))
    try:
        found = frequencies(network, _PERIODS + _RIGID)
    except (CostError, UnservedError) as error:
        return [], f"not known: {error}"
    turning = [2 * arb.pi() / w * seconds for w in found if not w.contains(0)]
    return [midpoint(period) for period in turning[:_PERIODS]], ""


def _damped_periods(model: Model) -> tuple[list[float], str]:
    """Those beside dashpots, with damping ratios; where many rods would take long, the command that has them."""
    if len(model.network.bars) > _MOST_RODS:
        return [], f"beside dashpots; `wavesym modes {model.name}.toml` has them, with damping ratios"
    try:
        rows = [row for row in modes(model, _DAMPED + _RIGID) if row.period and row.damping < 1][:_DAMPED]
    except WavesymError as error:
        return [], f"not known: {error}"
    periods = [row.period for row in rows if row.period]
    texts = (
        f"T{k} = {_si(period, 's')} ({100 * row.damping:.3g} %)"
        for k, (row, period) in enumerate(zip(rows, periods, strict=True), 1)
    )
    return periods, f"{', '.join(texts)}, damping of critical in brackets; `wavesym modes` has more"


def _rods(physical: PhysicalScene, model: Model) -> Listing:
    """Rods that differ; behind a speed that is changed what it is taken as."""
    rods, seconds = physical.scale.rods, float(physical.scale.seconds)
    bars, written = model.network.bars, model.written_speeds
    changes = [float(bar.speed / speed) for bar, speed in zip(bars, written, strict=True)] if written else []
    rows: list[dict[str, Plain | Display]] = []
    for number, (rod, ratio) in enumerate(zip(rods.all, rods.ratios, strict=True), 1):
        delay = seconds * float(ratio)
        speed = float(rod.length) / delay
        taken = f", taken as {speed * changes[number - 1]:.6g} m/s" if changes else ""
        rows.append(
            {
                "rod": number,
                "length": Display(float(rod.length), f"{float(rod.length):.6g} m"),
                "l/c": Display(delay, _si(delay, "s")),
                "c": Display(speed, f"{speed:.6g} m/s{taken}"),
                "impedance": float(rods.impedance(number - 1)),
            }
        )
    return Listing("rods_in_units", "Rods, with impedances over that of the first", rows)


def remarks(physical: PhysicalScene) -> Iterator[str]:
    """What someone who knows the structure should look at twice."""
    rods = physical.scale.rods.all
    if rounded := physical.scale.rods.rounded_ratios:
        yield f"ratios of delays to the first are irrational and rounded likewise: {rounded}"
    low, high = _KAPPA
    for at, kappa in _runs([float(kappa) for kappa in physical.kappa]):
        mass = _NAMES[physical.scale.kind][0]
        if kappa < low:
            yield f"kappa = {kappa:.3g} of {at}, below {low:g}: the {mass} of such rods hardly matters, springs may do"
        if kappa > high:
            yield f"kappa = {kappa:.3g} of {at}, above {high:g}: such bodies hardly matter beside their rods"
    slender = [rod.slenderness for rod in rods]
    for at, ratio in _runs(slender):
        if ratio < _SLENDER:
            verb = "are" if at.startswith("rods") else "is"
            yield f"{at} {verb} {ratio:.3g} times as long as wide: below {_SLENDER}, what a section does matters, too"


def _runs(values: Sequence[float | None]) -> Iterator[tuple[str, float]]:
    """Equal values one after another as one: "rods 1 to 10"."""
    start = 0
    for k in range(1, len(values) + 1):
        if k == len(values) or values[k] != values[start]:
            if (value := values[start]) is not None:
                yield f"rod {start + 1}" if k == start + 1 else f"rods {start + 1} to {k}", value
            start = k


def _several(values: Sequence[float]) -> str:
    if len(values) > _PERIODS:
        return f"{values[0]:.6g} to {values[-1]:.6g}"
    return ", ".join(f"{value:.6g}" for value in values) or "-"


def _si(seconds: float, unit: str) -> str:
    """A time for people."""
    for size, name in ((1.0, ""), (1e-3, "m"), (1e-6, "u")):
        if seconds >= size:
            return f"{seconds / size:.6g} {name}{unit}"
    return f"{seconds:.6g} {unit}"
