"""The modes of vibration of a scene: frequencies, damping, effective masses and shapes.

Undamped frequencies are the zeros of the determinant of the dynamic stiffness; how many lie below a number is counted
in balls (Wittrick and Williams, 1971), so that none is missed. With dashpots motions are exp(i w tau) with complex w,
by their absolute values; the zeros of the determinant in a circle are counted.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf, pi, sqrt
from typing import Any

import numpy as np
from flint import acb, arb, ctx, fmpq
from numpy.typing import NDArray

from wavesym.errors import CostError, WavesymError
from wavesym.exact.modes.cuts import Cut
from wavesym.exact.modes.damped_spectrum import DampedSpectrum
from wavesym.exact.modes.frequencies import Spectrum
from wavesym.exact.modes.shape import FoundModes, Mode
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import midpoint, nearest, upper_double
from wavesym.programs.modes.undamped_modes import damping_ratios
from wavesym.results.optional import require_packages
from wavesym.results.participation import Participation, effective_mass, participations
from wavesym.results.presentation import align_columns, csv_line, html_table, number_text
from wavesym.results.shapes import LineShapes, line_shapes
from wavesym.systems.station import Lines

COUNT = 10
_MOST = 2000
_BITS = 128
_FIRST_GUESS = 16  # modes, where it is not known how many lie below a frequency
_COMPLETE = "none is missed: the frequencies below the last one are counted in balls (Wittrick and Williams)"
_COUNTED = "none is missed: so many zeros of a determinant are counted in balls, in a circle beyond the last one"
_ROOTS = "none is missed: the determinant is a polynomial, whose roots are all known in balls"


@dataclass(frozen=True)
class ModeRow:
    """One mode.

    Attributes:
        number: from 1 on, rigid modes first, then shifts that stay: what rods and springs do not hold and dashpots do.
        omega: the angular frequency, in rad per s, or per tau without [units]; of a complex one the modulus.
        hz: omega / 2 pi.
        period: 1 / hz; None of a rigid mode.
        damping: the ratio to critical damping; 1 of what creeps, also of a shift that stays.
        decay: the rate at which its amplitude falls, as exp(-decay t), per s or per tau: minus the real part of s in
            exp(s t). Beyond critical damping of a modal ratio that of the slower motion.
        radius: omega, as the double it is, is right to so much, and so is the decay of a complex one: proved.
        effective_mass: what of the mass moves with all supports, in parts of the whole; None where nothing holds the
            chain, or gears make it mean nothing.
        shape: how far each node moves, the largest 1; complex where there are dashpots.
        loads: of each load and each end whose motion is prescribed, by name, its participation; none of complex ones.
    """

    number: int
    omega: float
    hz: float
    period: float | None
    damping: float
    decay: float
    radius: float
    effective_mass: float | None
    shape: dict[str, complex]
    loads: dict[str, Participation]


@dataclass(frozen=True, repr=False)
class Modes:
    """The modes of a scene, by their frequencies; `wavesym.modes` makes it.

    `complete` says whether none is missed, of as many or up to the frequency that were asked for, `why` in words;
    `time_unit` is "s", or None for tau. `notes` are lines of how the scene was read, where that may surprise.
    `line_shapes` are the shapes along lines, where they were asked for.
    """

    name: str
    modes: tuple[ModeRow, ...]
    complete: bool
    why: str
    time_unit: str | None
    exact: tuple[Mode, ...]
    cut: Cut
    line_shapes: tuple[LineShapes, ...] = ()
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.modes)

    def __iter__(self) -> Iterator[ModeRow]:
        return iter(self.modes)

    def __getitem__(self, place: int) -> ModeRow:
        return self.modes[place]

    def __repr__(self) -> str:
        unit = "Hz" if self.time_unit else "1/tau"
        first = ", ".join(f"{mode.hz:.6g}" for mode in self.modes[:3])
        more = ", ..." if len(self) > 3 else ""
        return f"Modes({self.name!r}, {len(self)} modes: {first}{more} {unit})"

    @property
    def frequencies(self) -> NDArray[np.float64]:
        """`hz` of each."""
        return np.array([mode.hz for mode in self.modes])

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with a row for each mode. WavesymError where pandas is not installed."""
        return require_packages("pandas", "sweep").DataFrame(self._rows(shapes=False)).set_index("number")

    def json(self, *, shapes: bool = False) -> str:
        """As JSON: `modes`, `complete`, `why`, `time_unit`; complex numbers of shapes as [real, imaginary]."""
        about: dict[str, Any] = {"complete": self.complete, "why": self.why, "time_unit": self.time_unit}
        if self.line_shapes:
            about["along"] = [
                {
                    "line": each.line,
                    "x": each.x.tolist(),
                    "shapes": [self._plain(row) for row in each.displacements.tolist()],
                }
                for each in self.line_shapes
            ]
        return json.dumps({"name": self.name, "modes": self._rows(shapes=shapes), **about}, indent=2) + "\n"

    def csv(self, *, shapes: bool = False) -> str:
        """As CSV: a line for each mode; shapes as a column for each node, in doubles, of complex ones two.

        Of shapes along lines a line for each place, in place of these.
        """
        if self.line_shapes:
            return self._along_csv()
        lines = []
        for mode, row in zip(self.modes, self._rows(shapes=False), strict=True):
            if shapes:
                for node, moved in mode.shape.items():
                    row |= {f"shape@{node}": moved.real} | ({} if self._is_real else {f"shape@{node}.imag": moved.imag})
            lines.append(row)
        return "".join(map(csv_line, [*lines[:1], *(row.values() for row in lines)]))

    def _along_csv(self) -> str:
        real = self._is_real
        parts = [""] if real else [".real", ".imag"]
        lines = [csv_line(["line", "x", *(f"mode {mode.number}{part}" for mode in self.modes for part in parts)])]
        for each in self.line_shapes:
            for x, moved in zip(each.x.tolist(), each.displacements.T.tolist(), strict=True):
                numbers = [n for q in moved for n in ([q.real] if real else [q.real, q.imag])]
                lines.append(csv_line([each.line, x, *numbers]))
        return "".join(lines)

    def _plain(self, row: Iterable[complex]) -> list[Any]:
        """Numbers of a shape as JSON has them."""
        return [q.real if self._is_real else [q.real, q.imag] for q in row]

    def text(self, *, shapes: bool = False) -> str:
        """As a table for people."""
        per, hz = ("rad/s", "Hz") if self.time_unit else ("rad/tau", "1/tau")
        head = ["mode", f"omega [{per}]", f"frequency [{hz}]", f"period [{self.time_unit or 'tau'}]", "damping"]
        if damped := any(mode.damping for mode in self.modes):
            head.append(f"decay [1/{self.time_unit or 'tau'}]")
        massive = any(mode.effective_mass is not None for mode in self.modes)
        loads = list(dict.fromkeys(name for mode in self.modes for name in mode.loads))
        rows = [[*head, *["effective mass"] * massive, *(f"participation@{name}" for name in loads)]]
        for mode in self.modes:
            period = "-" if mode.period is None else f"{mode.period:.7g}"
            mass = "-" if mode.effective_mass is None else f"{mode.effective_mass:.2%}"
            damping = f"{mode.damping:.4g}"
            known = [mode.loads.get(name) for name in loads]
            shares = ["-" if each is None else f"{each.factor:.5g}" for each in known]
            numbers = [str(mode.number), f"{mode.omega:.9g}", f"{mode.hz:.9g}", period, damping]
            rows.append([*numbers, *[f"{mode.decay:.7g}"] * damped, *[mass] * massive, *shares])
        lines = align_columns(rows, left=())
        if shapes and self.modes:
            nodes = list(self.modes[0].shape)
            table = [["node", *(f"mode {mode.number}" for mode in self.modes)]]
            table += [[node, *(_shape_text(mode.shape[node]) for mode in self.modes)] for node in nodes]
            lines += ["", *align_columns(table, left=())]
        if not self.modes:
            return f"no mode; {self.why}\n"
        radius = max((mode.radius for mode in self.modes), default=0.0)
        return "\n".join([*lines, "", f"right to {radius:.1e} {per}, proved; {self.why}"]) + "\n"

    def _repr_html_(self) -> str:
        rows = self._rows(shapes=False)
        return html_table(repr(self), rows[0] if rows else (), (map(_cell, row.values()) for row in rows))

    @property
    def _is_real(self) -> bool:
        return all(moved.imag == 0 for mode in self.modes for moved in mode.shape.values())

    def _rows(self, *, shapes: bool) -> list[dict[str, Any]]:
        rows = []
        for mode in self.modes:
            row: dict[str, Any] = {**vars(mode)}
            shape, loads = row.pop("shape"), row.pop("loads")
            row |= {f"{key}@{name}": value for name, load in loads.items() for key, value in _numbers(load)}
            row |= {"shape": dict(zip(shape, self._plain(shape.values()), strict=True))} if shapes else {}
            rows.append(row)
        return rows


def modes(
    model: Model,
    count: int = COUNT,
    below: float | None = None,
    lines: Lines | None = None,
    points: int | None = None,
) -> Modes:
    """The first modes of a model.

    Args:
        model: a chain without contacts; loads and outputs do not matter.
        count: how many, where `below` is None.
        below: a frequency: in Hz, or in rad per tau for a scene without units.
        lines: those of the chain, for shapes along them.
        points: at how many points of each rod; None for none.

    Raises:
        UnservedError: for contacts, and frequencies whose modes cannot be told apart.
        WavesymError: for a count, or a frequency, that is not positive.
        CostError: for more modes than can be found in a minute.
    """
    if count < 1 or (below is not None and not below > 0):
        name, value = ("count", count) if below is None else ("below", below)
        raise WavesymError(f"{name}: {value} is not positive; write a number above 0")
    if count > _MOST:
        raise CostError(f"--count: {count} modes, the limit is {_MOST} (fewer modes help)")
    model.network.refuse_loss()
    damped = model.network.loses
    spectrum = DampedSpectrum(model.network) if damped else Spectrum(model.network)
    first = spectrum.complete(count if below is None else _FIRST_GUESS)
    found = first.modes
    seconds = fmpq(1) if model.clock is None else model.clock.seconds
    per_tau = nearest(seconds)
    reach_needed = abs(complex(found[-1].frequency)) if len(found) == count else inf
    if below is not None:
        reach_needed = limit = below * (2 * pi * per_tau if model.clock else 1.0)
        wanted = _FIRST_GUESS
        while len(found) == wanted and abs(complex(found[-1].frequency)) <= limit:
            if len(found) >= _MOST:
                raise CostError(f"--below: {below:g} has more modes below it, the limit is {_MOST} (a lower one helps)")
            wanted *= 2
            first = spectrum.complete(wanted)
            found = first.modes
        found = [mode for mode in found if abs(complex(mode.frequency)) <= limit]
    rows = tuple(_row(model, k, mode, seconds) for k, mode in enumerate(found, 1))
    if isinstance(spectrum, Spectrum):
        rows = _with_ratios(model, rows, spectrum, per_tau)
    complete = first.reach >= reach_needed
    why = _why(first, complete, model, per_tau) if damped else _COMPLETE
    unit = "s" if model.clock else None
    along = line_shapes(found, spectrum.cut, model, lines, points) if lines and points else ()
    notes = (*model.labels.structure_notes, *_notes(found))
    return Modes(model.name, rows, complete, why, unit, tuple(found), spectrum.cut, along, notes)


def _why(found: FoundModes, complete: bool, model: Model, per_tau: float) -> str:
    """Whether modes of a chain with dashpots are all there, and why."""
    per = "rad/s" if model.clock else "rad/tau"
    reach = f"none is missed up to {found.reach / per_tau:.6g} {per}"
    if complete:
        return _ROOTS if found.are_roots else _COUNTED
    if found.meeting is not None:
        place = found.meeting / per_tau
        return f"{reach}; near {place:.6g} {per} two or more meet which cannot be told apart, and modes end there"
    return f"{reach}; beyond, each is proved, and that none is missed is not"


def _notes(found: Sequence[Mode]) -> list[str]:
    """What frequencies alone do not say: shifts, and shapes that are modes more than once."""
    notes = []
    if shifts := [number for number, mode in enumerate(found, 1) if mode.stays]:
        notes.append(
            f"frequency 0 of {_mode_numbers(shifts)}: motion without strain that dashpots alone resist (a rotor that "
            "turns against bearings), so that a shift stays"
        )
    places: dict[int, list[int]] = {}
    for number, mode in enumerate(found, 1):
        places.setdefault(id(mode), []).append(number)
    notes += [
        f"{_mode_numbers(same)} are one shape whose frequency is a zero of the determinant {len(same)} times: "
        "motion dies away as t exp(s t), too, where that is twice (critical damping)"
        for same in places.values()
        if len(same) > 1
    ]
    return notes


def _mode_numbers(modes: Sequence[int]) -> str:
    return f"mode{'s' * (len(modes) > 1)} {', '.join(map(str, modes))}"


def _row(model: Model, number: int, mode: Mode, seconds: fmpq) -> ModeRow:
    w = mode.frequency
    size = abs(w) if isinstance(w, acb) else w
    with ctx.workprec(_BITS):  # what a double leaves off an exact frequency is in its radius
        angular = size / arb(seconds)
        fall = w.imag / arb(seconds) if isinstance(w, acb) else arb(0)
        omega, decay = midpoint(angular), midpoint(fall)
        radius = upper_double(abs(angular - omega).max(abs(fall - decay)))
    ratio = midpoint(w.imag / size) if isinstance(w, acb) and not size.contains(0) else float(mode.stays)
    return ModeRow(
        number=number,
        omega=omega,
        hz=omega / (2 * pi),
        period=2 * pi / omega if omega else None,
        damping=ratio,
        decay=decay,
        radius=radius,
        effective_mass=None if isinstance(w, acb) else effective_mass(model.network, mode),
        shape=_shape(model.network, mode),
        loads={} if isinstance(w, acb) else participations(model.network, mode, _largest(model.network, mode)),
    )


def _with_ratios(model: Model, rows: Sequence[ModeRow], spectrum: Spectrum, per_tau: float) -> tuple[ModeRow, ...]:
    """Modes with the damping that the scene gives them; rigid ones have none."""
    if model.damping is None:
        return tuple(rows)
    elastic = [row.omega * per_tau for row in rows if row.omega]
    named = max(model.damping.modes or (0,))
    known = elastic
    if len(elastic) < named:
        frequencies = [midpoint(abs(mode.frequency)) for mode in spectrum.first(named + 1)]  # one may be rigid
        known = [w for w in frequencies if w]
    ratios = iter(damping_ratios(model.damping, known).ratios_at(np.array(elastic)).tolist())
    return tuple(_with_ratio(row, next(ratios)) if row.omega else row for row in rows)


def _with_ratio(row: ModeRow, ratio: float) -> ModeRow:
    """A mode with a damping ratio; beyond 1 it has two motions, and decay is that of the slower one."""
    rate = ratio if ratio <= 1 else 1 / (ratio + sqrt(ratio * ratio - 1))
    return replace(row, damping=ratio, decay=rate * row.omega)


def _largest(network: Network, mode: Mode) -> arb:
    """How far that point of the network moves that moves most; where all rest, how far rods do between them."""
    count = len(network.points)
    moved: arb = max(mode.points[:count], key=lambda q: abs(float(q)))
    if mode.amplitudes:
        moved = max(mode.amplitudes.values(), key=lambda a: abs(float(a)))
    if not moved.contains(0):
        return moved
    bars = (bar for bar in mode.stiffness.network.bars if min(bar.left, bar.right) < count <= max(bar.left, bar.right))
    sizes = (mode.points[max(bar.left, bar.right)] / (mode.frequency * bar.delay).sin() for bar in bars)
    largest: arb = max(map(abs, sizes), key=float, default=arb(1))
    return largest


def _numbers(load: Participation) -> Iterator[tuple[str, float | None]]:
    yield "participation", load.factor
    if load.effective_mass is not None:
        yield "effective_mass", load.effective_mass


def _shape(network: Network, mode: Mode) -> dict[str, complex]:
    """How far the points of the network move, those of its cuts left out, in parts of the largest; 0 of all at rest."""
    own = mode.points[: len(network.points)]
    moved = [0j if each.contains(0) else complex(each) for each in own]
    largest = max(moved, key=abs) or 1.0
    names: dict[str, complex] = {}
    for point, each in zip(network.points, moved, strict=True):
        name = point.label
        names.setdefault(name if name not in names else f"{name}+", each / largest if each else 0j)
    return names


def _shape_text(displacement: complex) -> str:
    return (
        f"{displacement.real:.5f}"
        if displacement.imag == 0
        else f"{abs(displacement):.5f} at {np.degrees(np.angle(displacement)):.1f} deg"
    )


def _cell(value: Any) -> str:
    return "-" if value is None else number_text(value) if isinstance(value, float) else str(value)
