"""The mathematics of a scene: its derivation, coefficients and outputs in closed form."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

from wavesym.errors import UnservedError, WavesymError
from wavesym.programs.request import refuse_unknown
from wavesym.scene import Scene, lower
from wavesym.scene.lowering import named_chain

if TYPE_CHECKING:
    from wavesym.derivation.equations import Equations
    from wavesym.derivation.table import Row, Table
    from wavesym.exact.tables.network_table import NetworkTable
    from wavesym.mechanics.chain import Chain
    from wavesym.mechanics.model import Model
    from wavesym.mechanics.node import System

MOST_FACTORED = 100_000  # coefficients of a symbolic table; half a millisecond each, however small

_REMEDY = "leave it out: tables and derivations are of waves alone"


def table(scene: Scene, intervals: int | None = None) -> Table | NetworkTable:
    """The unit responses of all sources of the scene's system, exact; errors as of `tables`."""
    from wavesym.documents.named_table import named_table
    from wavesym.exact.tables.network_table import network_table
    from wavesym.numbers.doubles import rational

    lowered = lower(scene)
    lowered.refuse_damping(_REMEDY)
    network, until, chain = lowered.network, rational(lowered.horizon()), named_chain(scene)
    return named_table(chain, network, intervals, until) if chain else network_table(network, intervals, until)


def tables(scene: Scene, intervals: int | None = None) -> list[Row]:
    """The rows of the coefficient table, exact.

    Args:
        scene: whose system it is.
        intervals: how many of every function; None for those that the horizon needs.

    Returns:
        One row for each term: in the interval that it names, the derivative of the wave function gains
        value * exp(-rate * w) * w**power, all dimensionless. In a general chain `interval` is the tau at which the wave
        leaves its end of the rod.

    Raises:
        UnservedError: for a chain that has contacts, or a node whose polynomial does not split.

    >>> import wavesym
    >>> row = wavesym.tables(wavesym.Scene.from_toml("building_m2"), intervals=1)[0]
    >>> row.function, row.rod, row.source, row.interval, row.rate, row.power, row.value
    ('f', 1, 'a', 1, Fraction(0, 1), 0, Fraction(-4, 1))
    """
    from wavesym.numbers.doubles import fraction

    return [
        row._replace(
            interval=row.interval if isinstance(row.interval, int) else fraction(row.interval),
            rate=fraction(row.rate),
            value=fraction(row.value),
        )
        for row in table(scene, intervals).rows()
    ]


def symbolic_tables(scene: Scene, intervals: int | None, format: str) -> tuple[list[str], Iterator[str]]:
    """The table as rational functions of the parameters: what the symbols stand for, then its lines, in a format.

    Parameters and rates that are equal in the scene are equal in the table. CostError where it would be absurd.
    """
    from wavesym.derivation.symbolic import in_rates, symbolic
    from wavesym.derivation.table import full_table
    from wavesym.derivation.table_size import refuse_costly
    from wavesym.documents.tables import symbolic_lines
    from wavesym.numbers.doubles import rational

    lowered = lower(scene)
    symbols = in_rates(symbolic(_paper_chain(scene, lowered, "--symbolic", "tables")))
    until = rational(lowered.horizon())
    refuse_costly(symbols.chain, intervals, until)
    made = full_table(symbols.chain, intervals, until, most=MOST_FACTORED)
    merged = [f"{name} = {ratio}" for name, ratio in symbols.meaning.items() if str(ratio) != name]
    return merged, symbolic_lines(made, symbols, scene.name, format)


def formula(
    scene: Scene, output: str, until: float | Fraction | None = None, format: str = "text", *, symbolic: bool = False
) -> str:
    """An output in closed form between its breakpoints, with exact coefficients.

    Args:
        scene: whose contacts do not open, and whose modes are not damped.
        output: its name, such as "strain@0.5"; its place may be written in any way that a scene has for it.
        until: in the time unit of the results, or tau; None for the horizon.
        format: "text", "latex", "sympy" (one expression in `tau`) or "c" (a function; but for `symbolic` a comment has
            its proved bound).
        symbolic: whether coefficients are functions of the parameters: of the paper's systems only.

    Returns:
        The text, which ends with a line break.

    Raises:
        WavesymError: for an output, a format or a time that is none.
        UnservedError: where there is no closed form.
        CostError: for a formula of too many terms.
        ToleranceError: where a function in C, in doubles, would be wrong by more than the scene's tolerance.

    >>> import wavesym
    >>> print(wavesym.formula(wavesym.Scene.from_toml("drive_m1"), "strain@0", 1), end="")
    strain@0 of drive_m1, tau from 0 to 1: the sum of
    from tau = 0 on, w = tau:
        -1 + exp(-w)
    """
    from wavesym.documents.formula import output_formula, symbolic_formula
    from wavesym.numbers.doubles import nearest, rational

    refuse_unknown("format", format, ("text", "latex", "sympy", "c"))
    model, output = lower(scene), _output_name(scene, output)
    if until is not None:
        last = rational(Fraction(repr(float(until)) if isinstance(until, float) else until)) / (
            model.clock.per_tau if model.clock else 1
        )
        if not 0 < last <= model.until:
            unit, horizon = "tau", f"{nearest(model.until):.9g} tau"
            if model.clock:
                unit, horizon = model.clock.unit, model.clock.format(model.until)
            raise WavesymError(f"--until: {float(until):g} {unit} is not between 0 and the horizon, {horizon}")
        model = model.shorten(last)
    if not symbolic:
        return output_formula(model, output).render(format)
    from wavesym.derivation.symbolic import in_rates
    from wavesym.derivation.symbolic import symbolic as in_letters

    chain = _paper_chain(scene, model, "--symbolic", "formula")
    return symbolic_formula(model, output, in_rates(in_letters(chain)), chain.nodes[-1].velocity).render(format)


def _output_name(scene: Scene, output: str) -> str:
    """What a scene calls an output whose place may be written in another way; the same where it has none there."""
    quantity, _, place = output.partition("@")
    if not place or all(each.quantity != quantity or each.name == output for each in scene.outputs):
        return output
    with suppress(WavesymError):
        written = scene.with_({f"output.{quantity}": [place]}).outputs
        places = [each.place for each in written if each.quantity == quantity]
        return next(
            (each.name for each in scene.outputs if (each.quantity, [each.place]) == (quantity, places)), output
        )
    return output


class Derivation(str):
    """A derivation: text, and for the paper's systems SymPy objects, in the paper's letters.

    `equations` has for each system (a building has two bases) `delay_equations`, `recurrences` and the `closures` of
    these: tuples of a SymPy `equation` and the rods i = `first`, `first` + `step`, ... `last` that it holds for, a
    closure with the `rate` gamma at which it is needed. `symbols` has what stands in them by name.
    """

    _systems: tuple[System, ...] = ()
    _m: int | None = None

    @cached_property
    def equations(self) -> tuple[Equations, ...]:
        """Those of each system, for any m, or written out for the m that was asked for or that a scene has.

        None for a general chain.
        """
        from wavesym.derivation.equations import equations

        return equations(self._systems, self._m)


def derive(source: str | Scene, m: int | None = None, format: str = "text") -> Derivation:
    """The derivation of a system, or of a scene: boundary conditions, delay equations, coefficient recurrences.

    Args:
        source: "collision", "drive", "building" (both bases), or a scene, its path or the name of a built-in one; of a
            general chain it is the law of each kind of node.
        m: how many elastic elements; then every line is written out, and so are `equations`. A scene has its own.
        format: "text", "latex", "json", or "fragment": LaTeX to be \\input.

    Returns:
        The text, which has SymPy objects as `equations`.

    Raises:
        WavesymError: for an m that the system does not have, and for what is neither a system nor a scene.

    >>> import wavesym
    >>> print(wavesym.derive("drive", 1).splitlines()[0])
    drive, m = 1
    >>> wavesym.derive("drive").equations[0].delay_equations[0].equation.lhs
    Derivative(f(1, z), z)*kappa[1] + Derivative(f(1, z), (z, 2))
    >>> wavesym.derive("drive", 2).equations[0].closures[1].equation
    Eq(S_f[2, n], -S_g[2, n])
    """
    from wavesym.derivation.symbolic import symbolic
    from wavesym.documents.derivation.document import derivation, network_derivation, scene_derivation
    from wavesym.documents.derivation.statement import systems
    from wavesym.systems import presets

    if isinstance(source, str) and source not in presets():
        source = Scene.from_toml(source)
    if isinstance(source, str):
        made = Derivation(derivation(source, m, format))
        made._systems, made._m = tuple(systems(source, m)), m
        return made
    lowered = lower(source)
    lowered.refuse_damping(_REMEDY)
    chain = named_chain(source)
    if chain is None:
        return Derivation(network_derivation(lowered, format))
    made = Derivation(scene_derivation(source.name, symbolic(chain), format))
    made._systems, made._m = (chain.system,), chain.m
    return made


def walks(source: str | Scene, m: int | None, intervals: int, format: str = "text") -> str:
    """The walk polynomials of `derive`'s systems with m elastic elements, or a scene: text, latex, fragment or json.

    WavesymError for an m that the system does not have; CostError where the polynomials would be absurd.
    """
    from wavesym.derivation.symbolic import generic, symbolic
    from wavesym.documents.derivation.statement import systems
    from wavesym.documents.walks import walk_polynomials

    if isinstance(source, str):
        assert m is not None  # polynomials are those of one chain
        return walk_polynomials((generic(system, m) for system in systems(source, m)), intervals, format)
    return walk_polynomials([symbolic(_paper_chain(source, lower(source), "--walks", "derive"))], intervals, format)


def _paper_chain(scene: Scene, lowered: Model, option: str, command: str) -> Chain:
    """The chain as the paper has it. UnservedError for a general chain."""
    lowered.refuse_damping(_REMEDY)
    chain = named_chain(scene)
    if chain is None:
        raise UnservedError(
            f"system.type: {lowered.labels.type} has no {option}, as collision, drive and building have; "
            f"`{command}` without {option} takes a chain"
        )
    return chain
