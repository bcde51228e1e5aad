"""A scene's outputs as one function of tau: right to the last bit, or by a program where that would cost too much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wavesym.errors import CostError, ToleranceError, UnservedError, WavesymError
from wavesym.exact.contacts.events import events
from wavesym.exact.reference import Reference
from wavesym.mechanics.event import ContactEvent
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.programs.choice import attempts, best
from wavesym.programs.program import Program, Provenance
from wavesym.results.horizon import check_horizon

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Response:
    """A scene's outputs as one function: the exact tables in ball arithmetic, each value rounded once.

    Where these would cost too much, or nothing but modes serves the scene, it is the program that `generate` takes.
    `outputs` are their names, `units` what they are told in (empty without [units]), `seconds_per_tau` what one tau is
    (None without), `tau_max` the end of the horizon; `error_bound` is relative to an output's largest value.
    `events` are what contacts do that open and close, in order of time.
    `wavesym.evaluator` makes it.
    """

    model: Model
    _programs: list[Program] = field(default_factory=list, init=False, repr=False, compare=False)

    @cached_property
    def _reference(self) -> Reference:
        return Reference(self.model)

    @property
    def outputs(self) -> tuple[str, ...]:
        return tuple(probe.name for probe in self.model.probes)

    @property
    def units(self) -> tuple[str, ...]:
        return tuple(probe.unit for probe in self.model.probes)

    @property
    def seconds_per_tau(self) -> float | None:
        return nearest(self.model.clock.seconds) if self.model.clock else None

    @property
    def tau_max(self) -> float:
        return self.model.horizon()

    @property
    def error_bound(self) -> float:
        program = self.program
        return program.error_bound if program else 2.0**-53

    @property
    def bounds(self) -> tuple[float, ...]:
        """That of each output: `error_bound`, unless an output is held to no tolerance."""
        program = self.program
        return program.bounds if program else (2.0**-53,) * len(self.outputs)

    @property
    def program(self) -> Program | None:
        """The program that values are of; None where they are right to the last bit. CostError as where it is called.

        Many values may need one where a few do not.
        """
        self.prepare()
        return self._programs[0] if self._programs else None

    def prepare(self) -> None:
        """Do what is done once, however many values are computed. Raises as where it is called."""
        if not self._programs:
            self._values([])

    @property
    def acting_model(self) -> Model:
        """What values are of: the model, or where a program takes lines in place of shapes the one with these."""
        return self.program.provenance.model if self.program else self.model

    @cached_property
    def events(self) -> tuple[ContactEvent, ...]:
        return events(self.model)

    def __call__(self, tau: ArrayLike, *, strict: bool = False) -> NDArray[np.float64]:
        """Values at instants of tau.

        Args:
            tau: instants, dimensionless, of any shape.
            strict: whether an instant outside the horizon is an error.

        Returns:
            Shape (len(outputs), *tau.shape), in `units`; NaN, with one warning, where tau is outside [0, tau_max].

        Raises:
            WavesymError: where `strict`, for tau outside [0, tau_max].
            CostError, ToleranceError: where no program computes the scene in moderate time, or to its tolerance.
        """
        taus = np.asarray(tau, dtype=np.float64)
        check_horizon(taus, self.tau_max, strict=strict)
        return self.values(taus)

    def values(self, tau: ArrayLike) -> NDArray[np.float64]:
        """The same without a word where tau is out of [0, tau_max]."""
        taus = np.asarray(tau, dtype=np.float64)
        flat = taus.ravel()
        inside = (flat >= 0.0) & (flat <= self.tau_max)
        out = np.full((len(self.outputs), flat.size), np.nan)
        out[:, inside] = self._values(flat[inside].tolist())
        return out.reshape(len(self.outputs), *taus.shape)

    def _values(self, taus: Sequence[float]) -> ArrayLike:
        if not self._programs:
            try:
                return self._reference.values(taus)
            except (CostError, UnservedError) as error:
                self._programs.append(_program(self.model, error))
        return self._programs[0].evaluate(taus)


def _program(model: Model, error: WavesymError) -> Program:
    """What `generate` takes. ToleranceError where no program is good enough, the error where there is none at all.

    Of samples and records it is told what each program would need.
    """
    tried = attempts(model)
    served = any(one.form or isinstance(one.error, ToleranceError) for one in tried)
    if not served and not model.spacing and not model.damping:
        raise error
    choice = best(model, tried)
    return choice.evaluator.program(Provenance(choice.model, choice.reason))
