"""Model -> Program, for the numbers of modes at run time: a chain as tables, whose modes are found when it runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from flint import fmpq

from wavesym.errors import UnservedError, WavesymError
from wavesym.exact.modes.shape import rigid
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Network
from wavesym.numbers.doubles import nearest
from wavesym.numbers.reals import DOUBLE
from wavesym.programs.mode_sets.parameters import ModeParameters, SampledAmplitudes, mode_parameters, sampled_amplitudes
from wavesym.programs.modes.evaluator import driven_inputs, modes
from wavesym.programs.modes.modal_system import LANES, padded_count
from wavesym.programs.modes.stepping import SteppedModes
from wavesym.programs.program import (
    Input,
    Program,
    ProgramOutput,
    Provenance,
    ReferenceValues,
    SteppedRow,
    SteppedValues,
)
from wavesym.programs.request import Request, refuse_beside
from wavesym.programs.runtime.laws import RuntimeLaws
from wavesym.programs.tables import Tables, firsts

_SERVED = ("peaks",)
_POINTS, _PER_CROSSING = 16, 4  # instants of a step that is looked at closely
_BLOCK = 32
_CHECKED, _FINER = 40, 8  # instants of a self-test, whose values are so many times as good as the tolerance
_ULPS = 16 * 2.0**-53  # by which a step may differ from the spacing
_ANY, _NOT_NEGATIVE, _POSITIVE = 0, 1, 2
_REMEDY = {
    "gradients": "write wavesym.model(scene, [...]).gradients(tau) in Python",
    "batch": "build one model after the other",
    "misfit": "sum up what `sample` gives less the data",
    "bound": "write wavesym.model(scene, [...]).bounds() in Python",
}


def mode_sets_program(
    model: Model, request: Request, amplitudes: Sequence[tuple[str, AppliedLoad]], *, tested: bool = False
) -> Program:
    """The program of a model whose numbers `request.runtime` are those of modes, given at run time.

    `amplitudes` are those of its loads, each with what it is called. UnservedError, ToleranceError, CostError as for
    `mode_parameters` and `enough_modes`, and for parts that modes do not have.
    """
    evaluator = "auto" if request.evaluator == "modes" else request.evaluator
    refuse_beside(
        "--runtime of modes",
        (
            ("--evaluator", evaluator, "auto"),
            ("--precision", request.precision, "double"),
            ("--optimize", request.optimize, None),
            ("--kappa-max", request.kappa_max, None),
            ("--step", request.step, None),
        ),
    )
    if request.stream and "load" in request.runtime:
        raise WavesymError(
            "--runtime: load is no parameter of a stream, which takes samples as they come; leave it out"
        )
    for part in request.parts:
        if part not in _SERVED:
            raise UnservedError(f"--with: {part} is not supported by modes at run time ({_REMEDY[part]})")
    parameters = mode_parameters(model, request.runtime, amplitudes)
    parameters.like.refuse()
    return ModeSetsTables(parameters, request.stream).program(request, tested=tested)


def _values(proved: SteppedModes, tau_max: float) -> ReferenceValues:
    taus = np.linspace(0.0, tau_max, _CHECKED)
    return ReferenceValues(tuple(taus.tolist()), tuple(map(tuple, proved.evaluate(taus).tolist())))


@dataclass(frozen=True)
class ModeSetsTables:
    """What templates/c/mode_sets reads, of the cut network of `parameters.like`."""

    parameters: ModeParameters
    streamed: bool = False
    doublings: int = 0
    """How often there are twice as many modes as the scene's own numbers need, for others that need more."""

    @property
    def _network(self) -> Network:
        return self.parameters.like.cut.network

    @cached_property
    def _stiffness(self) -> Stiffness:
        return Stiffness(self._network)

    @cached_property
    def _places(self) -> dict[int, int]:
        """The place of each point: those that are free first, in the order of rows."""
        free = self._stiffness.points
        held = [n for n in range(len(self._network.points)) if n not in self._stiffness.rows]
        return {point: place for place, point in enumerate([*free, *held])}

    @property
    def mode_count(self) -> int:
        """How many modes there are."""
        return min(self.parameters.fewest << self.doublings, self.parameters.like.most)

    @cached_property
    def amplitudes(self) -> SampledAmplitudes:
        """Those of the loads."""
        return sampled_amplitudes(self.parameters, streamed=self.streamed)

    def program(self, request: Request, *, tested: bool = False) -> Program:
        """With its tables, in C alone."""
        model = self.parameters.model
        tables, constants = self._tables(), self._constants()
        names = ", ".join(field.name for field in self.parameters.fields)
        reason = (
            f"modes with {names} at run time, {constants['found']} of them, enough for the scene's own numbers and "
            "some more; errors are estimated"
        )
        streamed, spacing = self.streamed, constants["spacing"]
        if streamed:
            constants |= {"shortest": spacing * (1 - _ULPS), "longest": spacing * (1 + _ULPS)}
            tables |= {"load_unit": tuple(nearest(given.size) for given in self._inputs)}
        sources = tuple(given.label for given in self._inputs) if streamed else ()
        made = Program(
            "mode_sets",
            DOUBLE,
            model.horizon(),
            tuple(ProgramOutput(probe.name, nearest(model.tolerance), 0.0) for probe in model.probes),
            tables,
            constants,
            DOUBLE.bytes * sum(map(len, tables.values())),
            Provenance(model, reason, request.options(model)),
            proved=False,
            laws=RuntimeLaws(self.parameters.fields, {}, ()),
            parts=request.parts,
            sources=sources,
            step="spacing" if streamed else "",
        )
        return self._with_reference(made) if tested else made

    @property
    def _inputs(self) -> tuple[Input, ...]:
        """The loads of a stream."""
        return driven_inputs(self.parameters.model, self.parameters.like.sources)

    def _with_reference(self, made: Program) -> Program:
        """With values of the scene's own numbers by modes that are proved to leave out next to nothing."""
        model = self.parameters.model
        proved = modes(replace(model, tolerance=model.tolerance / _FINER), DOUBLE)
        outputs = tuple(
            replace(output, largest=exact.largest) for output, exact in zip(made.outputs, proved.outputs, strict=True)
        )
        reference = self._stepped_values(proved.scheme) if self.streamed else _values(proved.scheme, made.tau_max)
        return replace(made, outputs=outputs, reference=reference)

    def _stepped_values(self, proved: SteppedModes) -> SteppedValues:
        """What a stream gives under the scene's own loads, at some of their samples up to the last one."""
        spacing, tau_max = nearest(self.amplitudes.step), self.parameters.model.horizon()
        sizes = np.array([nearest(given.size) for given in self._inputs])
        loads = self.amplitudes.samples[1:] * sizes
        last = min(len(loads), int(tau_max / spacing))
        checked = np.unique(np.linspace(1, last, min(last, _CHECKED)).astype(int))
        values = dict(zip(checked.tolist(), proved.evaluate(spacing * checked).T.tolist(), strict=True))
        return SteppedValues(
            tuple(
                SteppedRow(spacing, tuple(row), tuple(values.get(k, ())))
                for k, row in enumerate(loads[:last].tolist(), 1)
            )
        )

    def _constants(self) -> dict[str, float]:
        like, model = self.parameters.like, self.parameters.model
        network, stiffness = self._network, self._stiffness
        damping = model.damping
        rayleigh = damping.modes if damping and damping.modes else (0, 0)
        count, loads, outputs = self.mode_count, len(like.drivers), len(model.probes)
        spacing, tau_max = nearest(self.amplitudes.step), model.horizon()
        whole = int(tau_max / spacing + 5e-10)
        crossing = nearest(model.network.shortest) if model.network.bars else spacing
        return {
            "modes": count + (loads if rayleigh[0] else 0),
            "found": count,
            "loads": loads,
            "amplitudes": self.amplitudes.samples.shape[1],
            "group": LANES,
            "filled": padded_count(outputs),
            "bars": len(network.bars),
            "rows": len(stiffness.points),
            "places": len(network.points),
            "links": len(network.links),
            "massive": int(not network.bars),
            "free": int(rigid(network) is not None),
            "ratios": len(damping.ratios) if damping else 1,
            "first_mode": rayleigh[0],
            "second_mode": rayleigh[1],
            "samples": len(self.amplitudes.samples),
            "halves": 2 * whole + int(tau_max / spacing - whole >= 0.5),
            "moving": int(any(output.order for output in like.outputs)),
            "sums": int(self._has_sums),
            "points": max(_POINTS, -int(-spacing * _PER_CROSSING // crossing)) + 1,
            "block": _BLOCK,
            **self._starts,
            "spacing": spacing,
            "tau_max": tau_max,
            "tolerance": nearest(model.tolerance),
        }

    @property
    def _has_sums(self) -> bool:
        """Whether integrals of loads count in outputs: displacements and velocities that moving ends impose."""
        like = self.parameters.like
        ground = any(self._network.points[each.point].motion for each in like.drivers)
        return ground and any(output.order < 2 for output in like.outputs)

    @cached_property
    def _numbers(self) -> dict[str, list[fmpq]]:
        """The scene's own numbers by kind, in the order in which they stand."""
        model, order = self.parameters.model, sorted(self._places, key=self._places.__getitem__)
        bars, points = model.network.bars, [self._network.points[point] for point in order]
        return {
            "rod_stiffness": [bar.impedance / bar.delay for bar in bars],
            "rod_mass": [bar.impedance * bar.delay for bar in bars],
            "mass": [point.mass for point in points],
            "spring": [point.stiffness for point in points],
            "link": [link.stiffness for link in self._network.links],
            "ratio": list(model.damping.ratios if model.damping else (fmpq(0),)),
            "factor": [each.weight for each in self.parameters.amplitudes]
            or [fmpq(1)] * self.amplitudes.samples.shape[1],
        }

    @cached_property
    def _starts(self) -> dict[str, int]:
        """Where numbers of each kind begin."""
        return dict(zip([*self._numbers, "values"], firsts(map(len, self._numbers.values())), strict=True))

    def _value_of(self, field: str, label: str, number: int) -> int:
        """Where a parameter stands among them."""
        kind, _, last = label.rpartition("_")
        of_rods_and_links = {"stiffness_bar": "rod_stiffness", "rod_mass_bar": "rod_mass", "stiffness_link": "link"}
        if field in ("load", "damping"):
            return self._starts["factor" if field == "load" else "ratio"] + number
        if kind in of_rods_and_links:
            return self._starts[of_rods_and_links[kind]] + int(last)
        return self._starts["mass" if field == "mass" else "spring"] + self._places[int(last)]

    def _tables(self) -> Tables:
        like, amplitudes = self.parameters.like, self.amplitudes
        spacing = nearest(amplitudes.step)
        return {
            "value_of_scene": tuple(nearest(number) for kind in self._numbers.values() for number in kind),
            **self._parameter_tables(),
            **self.layout,
            "rigid": tuple(self._rigid()),
            "is_zero": tuple(map(int, self.parameters.zero_outputs)),
            "group_moves": tuple(
                int(any(output.order for output in like.outputs[first : first + LANES]))
                for first in range(0, len(like.outputs), LANES)
            ),
            "amplitude_load": amplitudes.loads,
            "in_step": tuple(float(np.nextafter(rough.in_step / spacing, np.inf)) for rough in amplitudes.rough),
            "sample": tuple(amplitudes.samples.T.ravel().tolist()),
        }

    @cached_property
    def layout(self) -> Tables:
        """All that is neither a number of a part nor a sample: what hangs on what, and where outputs and loads are."""
        network, places, rows = self._network, self._places, len(self._stiffness.points)

        def coupling(left: int, right: int) -> int:
            """The row that names the coupling of two points."""
            return min(left, right) if max(left, right) < rows else len(places)

        bars = [(places[bar.left], places[bar.right]) for bar in network.bars]
        links = [(places[link.left], places[link.right]) for link in network.links]
        return {
            "parent": tuple(-1 if row is None else row for row in self._stiffness.parents),
            "beside": tuple(self._next_siblings()),
            **self._bar_tables(),
            "bar_left": tuple(left for left, _ in bars),
            "bar_right": tuple(right for _, right in bars),
            "bar_left_ratio": tuple(nearest(bar.ratios[0]) for bar in network.bars),
            "bar_right_ratio": tuple(nearest(bar.ratios[1]) for bar in network.bars),
            "bar_up": tuple(coupling(*pair) for pair in bars),
            "link_left": tuple(left for left, _ in links),
            "link_right": tuple(right for _, right in links),
            "link_ratio": tuple(nearest(link.ratio) for link in network.links),
            "link_up": tuple(coupling(*pair) for pair in links),
            **self._output_tables(),
            "load_place": tuple(places[each.point] for each in self.parameters.like.drivers),
            "load_gain": tuple(nearest(each.gain) for each in self.parameters.like.drivers),
        }

    def _parameter_tables(self) -> Tables:
        numbers = [
            (field.name, label, number, unit)
            for field in self.parameters.fields
            for number, (label, unit) in enumerate(zip(field.labels, field.units, strict=True))
        ]
        rayleigh = self.parameters.model.damping is not None and self.parameters.model.damping.modes is not None
        signs = {"load": _ANY, "damping": _POSITIVE if rayleigh else _NOT_NEGATIVE}
        return {
            "parameter_value": tuple(self._value_of(name, label, number) for name, label, number, _ in numbers),
            "parameter_unit": tuple(nearest(unit.size) for *_, unit in numbers),
            "parameter_sign": tuple(signs.get(name, _POSITIVE) for name, *_ in numbers),
        }

    def _next_siblings(self) -> Iterator[int]:
        """Of each row the next one with the same parent, in a circle."""
        parents = self._stiffness.parents
        for row, parent in enumerate(parents):
            alike = [other for other, of in enumerate(parents) if of == parent] if parent is not None else [row]
            yield alike[(alike.index(row) + 1) % len(alike)]

    def _bar_tables(self) -> Tables:
        """The rod that each bar is a part of, and how large a part."""
        cut, rods = self.parameters.like.cut, self.parameters.model.network.bars
        pieces = [(k, cut.firsts[k] + piece) for k in range(len(rods)) for piece in range(len(cut.places[k]) + 1)]
        return {
            "bar_rod": tuple(rod for rod, _ in pieces),
            "bar_part": tuple(nearest(self._network.bars[bar].length / rods[rod].length) for rod, bar in pieces),
        }

    def _rigid(self) -> Iterator[float]:
        found = rigid(self._network)
        points = sorted(self._places, key=self._places.__getitem__)
        yield from (nearest(found[point]) for point in points if found is not None)

    def _output_tables(self) -> Tables:
        like, model = self.parameters.like, self.parameters.model
        ends = [output.slope[1] if output.slope else None for output in like.outputs]
        forces = [probe.computed_quantity == "force" for probe in model.probes]
        scales = [
            probe.factor / (1 if end is None or force else self._network.bars[end.bar].length)
            for probe, end, force in zip(model.probes, ends, forces, strict=True)
        ]
        terms = [(self._places[point], weight) for output in like.outputs for point, weight in output.points.items()]
        return {
            "output_order": tuple(output.order for output in like.outputs),
            "output_power": tuple(output.power for output in like.outputs),
            "output_bar": tuple(-1 if end is None else end.bar for end in ends),
            "output_side": tuple(0 if end is None else end.side for end in ends),
            "output_force": tuple(map(int, forces)),
            "output_scale": tuple(map(nearest, scales)),
            "first_term": firsts(len(output.points) for output in like.outputs),
            "term_place": tuple(place for place, _ in terms),
            "term_weight": tuple(nearest(weight) for _, weight in terms),
        }
