"""Modes of a chain with dashpots: each has a complex frequency; and the truncation error, by their energy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

import numpy as np
from flint import acb, arb, ctx, fmpq_mat

from wavesym.errors import UnservedError
from wavesym.exact.joints.joint_law import JointLaw, joint_ends
from wavesym.exact.modes.cuts import Cut
from wavesym.exact.modes.damped_spectrum import DampedSpectrum
from wavesym.exact.modes.shape import Mode
from wavesym.exact.modes.stiffness import Stiffness
from wavesym.mechanics.network import Network
from wavesym.numbers.arrays import Array, Complex
from wavesym.programs.modes.dissipation import Dissipation, complexes, part
from wavesym.programs.modes.harmonic_response import LowFrequency, dashpots, read, series
from wavesym.programs.modes.loads import Roughness
from wavesym.programs.modes.modal_system import ModalSystem
from wavesym.programs.modes.projection import Driver, ModalOutput, share
from wavesym.programs.modes.truncation import ModalModel

_BITS = 320
_MORE = 1 + 1e-12


@dataclass(frozen=True)
class ComplexProjection:
    """Modes by columns, their rates (of exp(rate tau)), what outputs and loads are of them.

    `slow` (outputs, loads, 3) is what outputs have of second integrals, integrals and loads where all changes low;
    `load_remainders` (outputs, loads, modes + 1) what they have of loads beside the first 0, 1, 2, ... modes.

    `residuals` (outputs and then loads, powers, modes + 1) is what their states have without the first modes.
    """

    rates: Complex
    outputs: Complex
    shares: Complex
    slow: Array
    load_remainders: Array
    residuals: Array

    @property
    def w(self) -> Array:
        """The absolute values of their frequencies."""
        return np.abs(self.rates)

    @cached_property
    def load_terms(self) -> Complex:
        """What loads do to modes, z' = rate z + this; the real part of what outputs are of them counts."""
        twice = np.where(self.rates.imag != 0, 2.0, 1.0)  # for what is conjugate to it
        return np.asarray(self.shares * twice / (2 * self.rates))


@dataclass(frozen=True)
class ComplexModes(ModalModel[ComplexProjection]):
    """Its modes, and the truncation error of those that are left out (dissipation.py)."""

    SPECTRUM = DampedSpectrum
    MOST = 1000
    WORK = 20_000

    def project(self, count: int) -> ComplexProjection:
        """The first modes. UnservedError for what modes do not serve."""
        self.refuse()
        network = self.model.network
        network.refuse_corners()
        refuse_absorbing(network)
        found = self.spectrum.first(count)  # only then it is known how bars are cut
        for probe in self.massless_accelerations():
            raise UnservedError(
                f"output.acceleration: {probe.name}: modes with dashpots support no place without mass (pieces "
                "and `run` do)"
            )
        with ctx.workprec(_BITS), series():
            return project_complex(found, self.cut, self.outputs, self.drivers)

    def errors(self, known: ComplexProjection, count: int, loads: Sequence[Roughness] | None = None) -> Array:
        """What the modes after the first `count` can add to each output, under its own or other `loads`."""
        taken = min(count, len(known.rates))
        made = np.zeros(len(self.model.probes))
        for o, output in enumerate(self.outputs):
            powers = range(3 - output.order + 1)
            for j, rough in enumerate(self.roughness if loads is None else loads):
                ports = known.residuals[o], known.residuals[len(self.outputs) + j]
                size = min(ports[0][p, taken] * ports[1][3 - output.order - p, taken] for p in powers)
                made[o] += (rough.in_step + rough.steepest) * size
        return np.where(self.zero_outputs, 0.0, _MORE * made)

    def system(self, known: ComplexProjection, count: int) -> ModalSystem:
        """The system of the first `count` modes."""
        rates = known.rates[:count]
        orders = np.array([output.order for output in self.outputs])
        direct = np.zeros((*known.slow.shape[:2], 3))
        for o, order in enumerate(orders.tolist()):
            direct[o, :, 1 : 3 - order] = known.slow[o, :, : 2 - order][:, ::-1]
            direct[o, :, 0] = known.load_remainders[o, :, min(count, len(known.rates))]
        # a mode is rate z + loads; of one load, z = y' - conj(rate) y, y an oscillator's
        read = known.outputs[:, :count] * rates ** orders[:, None]
        pushed = known.load_terms[:, :count]
        phase = pushed[np.abs(pushed).argmax(axis=0), np.arange(len(rates))]
        phase = np.where(phase != 0, phase / np.where(phase != 0, np.abs(phase), 1.0), 1.0)
        pushed, read = pushed / phase, read * phase
        mixed = np.flatnonzero(np.abs(pushed.imag).max(axis=0) > 2.0**-50 * np.abs(pushed).max(axis=0))
        every = np.append(np.arange(len(rates)), mixed)
        pushes = np.append(pushed.real, pushed.imag[:, mixed], axis=1)
        read = np.append(read, 1j * read[:, mixed], axis=1)
        w = np.abs(rates[every])
        damping = np.clip(-rates[every].real / w, 0.0, 1.0)
        moved, moving = -np.real(read * rates[every].conj()), np.real(read)
        return ModalSystem(w, damping, pushes.T.copy(), moved, moving, direct).drop_outputs(self.zero_outputs)


def refuse_absorbing(network: Network) -> None:
    """UnservedError where dashpots swallow waves of some kind altogether: these have no modes.

    Waves that arrive where there is no mass are sent back changed by 2 Z (Z + C)^-1 - 1, with the impedances Z and the
    dashpots C; nothing is sent back where Z - C takes something to 0.
    """
    for joint in network.joints:
        law = JointLaw.assemble(network, joint)
        light = {k: row for row, k in enumerate(law.light)}
        rows = [[-law.damping[a][b] for b in light] for a in light]  # Z + C
        for each in joint_ends(network, joint):
            if each.place in light:
                impedance = network.bars[each.end.bar].impedance * each.ratio**2
                rows[light[each.place]][light[each.place]] += 2 * impedance
        if light and fmpq_mat(rows).det() == 0:
            first = network.points[joint.points[law.light[0]]]
            at = first.label
            raise UnservedError(
                f"system: dashpots as large as the impedance at {at} return nothing, which modes do not support "
                "(write larger or smaller ones, or take pieces or march)"
            )


def project_complex(
    found: Sequence[Mode], pieces: Cut, outputs: Sequence[ModalOutput], drivers: Sequence[Driver]
) -> ComplexProjection:
    """Those of the modes of a network that is cut, in the precision and with the power series that are set."""
    network = pieces.network
    low, losing = LowFrequency(Stiffness(network)), Dissipation(found, dashpots(network))
    loads = [low.driver(driver) for driver in drivers]
    values = [[acb(output.value(mode)) for mode in found] for output in outputs]
    shares = [[acb(share(driver, mode)) for mode in found] for driver in drivers]
    slow = np.zeros((len(outputs), len(loads), 3))
    beside = np.zeros((len(outputs), len(loads), len(found) + 1))
    for o, output in enumerate(outputs):
        for j, port in enumerate(loads):
            reads = read(low.response, output, port.point_motions)
            static = [arb(0)] * (2 - port.order) + [reads[k] for k in range(port.order + 1)]
            slow[o, j] = [float(each) for each in static]
            parts = zip(losing.rates, values[o], shares[j], strict=True)
            each = [(part(rate, b) * a * rate ** (output.order - 2)).real for rate, a, b in parts]
            beside[o, j] = [float(total) for total in accumulate(each, initial=static[2 - output.order])]
    return ComplexProjection(
        rates=np.array([complex(rate) for rate in losing.rates], complex),
        outputs=complexes(values, len(found)),
        shares=complexes(shares, len(found)),
        slow=slow,
        load_remainders=beside,
        residuals=losing.residual_norms([*map(low.output, outputs), *loads], [*values, *shares]),
    )
