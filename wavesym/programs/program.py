"""A program as a value: tables of numbers, what is proved of them, what they compute, and where they come from."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import ceil
from typing import TYPE_CHECKING, Literal

from flint import fmpq

from wavesym.exact.contacts.events import ContactEnd
from wavesym.mechanics.event import ContactEvent
from wavesym.mechanics.model import Model
from wavesym.numbers.reals import Real
from wavesym.programs.tables import Tables

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from wavesym.programs.runtime.laws import RuntimeLaws
    from wavesym.programs.schemes.scheme import Scheme


@dataclass(frozen=True)
class ProgramOutput:
    """An output: its name, its proved largest error relative to its largest value, and a lower bound of that value.

    Where contacts open and close, one that is 0 as far as can be told has the largest value 0, and what it may be
    nevertheless is the `bound`, relative to the scene's largest wave. An `incidental` one (`Probe`) is held to no
    tolerance.
    """

    name: str
    bound: float
    largest: float
    incidental: bool = field(default=False, kw_only=True)


class BoundedOutputs:
    """What has outputs, each with a bound of its error."""

    outputs: tuple[ProgramOutput, ...]

    @property
    def worst(self) -> ProgramOutput:
        """The output with the largest bound, of those that the tolerance is for."""
        return max((output for output in self.outputs if not output.incidental), key=lambda output: output.bound)

    @property
    def error_bound(self) -> float:
        """The largest error of any output relative to its largest value, incidental ones left out."""
        return self.worst.bound

    @property
    def bounds(self) -> tuple[float, ...]:
        """The error of each output: what all of them share, of an incidental one its own."""
        shared = self.error_bound
        return tuple(output.bound if output.incidental else shared for output in self.outputs)


@dataclass(frozen=True)
class Provenance:
    """What a program was made from, and how: `options` are those of `generate` that it depends on.

    `reason` says why it was taken and what was refused; `contacts` of a formal continuation open within the horizon.
    `events` is what contacts that open and close do, None where there are no such contacts. `shortfall` says by how
    much the tolerance may be missed, where that is not proved to be met. `step` is the time between two calls of a
    stream in tau, where it is requested.
    """

    model: Model
    reason: str
    options: str = ""
    contacts: tuple[ContactEnd, ...] = ()
    events: tuple[ContactEvent, ...] | None = None
    shortfall: str = ""
    step: fmpq | None = None


@dataclass(frozen=True)
class Input:
    """A load that is given: its source in the chain, and what 1 of the chain's is in the `unit` that a user gives."""

    source: str
    size: fmpq
    unit: str

    @property
    def name(self) -> str:
        """What a user calls it: a source without what it is a step of."""
        return self.source.removesuffix(":step")

    @property
    def label(self) -> str:
        """The name, with the unit where it has one."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


@dataclass(frozen=True)
class ReferenceValues:
    """The outputs at `taus`, correctly rounded doubles: values[output][k] is that at taus[k]."""

    taus: tuple[float, ...]
    values: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class SteppedRow:
    """A step of a stream: how long, the loads at its end, and the outputs there, unless they are not looked at."""

    dtau: float
    loads: tuple[float, ...]
    values: tuple[float, ...] = ()


@dataclass(frozen=True)
class SteppedValues:
    """What a stream gives from its start, step by step, wrong by at most `errors`, one an output, where known."""

    rows: tuple[SteppedRow, ...]
    errors: tuple[float, ...] = ()


@dataclass(frozen=True)
class Program(BoundedOutputs):
    """What computes the outputs of a scene for 0 <= tau <= `tau_max`, in `real` numbers; dimensionless.

    `kernel` names what runs its tables, in C and in NumPy: "closed", "pieces", "march", "hats" (one hat of each record,
    in NumPy alone), "modes", "runtime" and "stream" (in C alone).
    `tables` are flat, by name, each number as it is written, indices as ints (`first_...[g]` is where group g starts in
    a table, `first_...[g + 1]` where it ends); which there are, the `program` of each
    evaluator says, of marches march/tables.py, of modes modes/modal_system.py, of streams stream/tables.py.
    `constants` are single numbers. `bytes` is the size of the tables in C. `reference` is for a self-test.
    `laws` are functions of parameters that come at run time. `sources` are the names of loads that it takes while it
    runs, `step` the constant that says how long its steps are then: "spacing" where all are equal, "panel" where others
    cost accuracy, empty where it takes no loads. Of a stream `direct` has for each output the sources that act on it at
    once. `hats` says that records are added up hat by hat. Its error is `proved`, or an estimate. `numpy_only` says why
    there is no C of it, and what helps. `parts` are what C with parameters at run time has besides values.
    """

    kernel: str
    real: Real
    tau_max: float
    outputs: tuple[ProgramOutput, ...]
    tables: Tables
    constants: dict[str, float]
    bytes: int
    provenance: Provenance
    reference: ReferenceValues | SteppedValues | None = None
    sources: tuple[str, ...] = ()
    proved: bool = True
    laws: RuntimeLaws | None = None
    direct: tuple[tuple[int, ...], ...] = ()
    numpy_only: str = ""
    parts: tuple[str, ...] = ()
    step: Literal["", "spacing", "panel"] = ""
    hats: bool = False

    @property
    def evaluator(self) -> str:
        """What a user calls it."""
        return "march" if self.hats else self.kernel

    @property
    def has_equal_steps(self) -> bool:
        """Whether it is stepped exactly, in steps of one length: loads and outputs do not jump."""
        return self.step == "spacing"

    def evaluate(self, tau: ArrayLike) -> NDArray[np.float64]:
        """All outputs at tau, of shape (outputs, *tau.shape), in the type of the format; NaN where tau is out of range.

        Bit for bit what the generated NumPy gives. ArithmeticError where a march sees that its degree is too low.
        """
        return self._scheme.evaluate(tau)

    def each(self, tau: NDArray[np.float64]) -> NDArray[np.float64]:
        """Each output at instants of its own: tau and values are (outputs, n)."""
        import numpy as np

        from wavesym.programs.schemes.hats import HatScheme

        if isinstance(self._scheme, HatScheme):
            return self._scheme.each(tau)
        flat, back = np.unique(tau, return_inverse=True)
        return np.take_along_axis(self.evaluate(flat), back.reshape(tau.shape), axis=1)

    def instants(self, step: float) -> NDArray[np.float64]:
        """Instants of the horizon no more than `step` apart, both its ends included, where values are had soonest."""
        import numpy as np

        from wavesym.programs.schemes.hats import HatScheme

        if isinstance(self._scheme, HatScheme):
            return self._scheme.evenly(step)
        return np.linspace(0.0, self.tau_max, ceil(self.tau_max / step) + 1)

    @cached_property
    def _scheme(self) -> Scheme:
        """Its values in NumPy, which is loaded for these alone: whoever writes C waits for none of it."""
        import numpy as np

        from wavesym.programs.schemes import SCHEMES

        real = np.dtype(f"f{self.real.bytes}").type
        return SCHEMES[self.kernel](self.tables, self.constants, self.tau_max, real)
