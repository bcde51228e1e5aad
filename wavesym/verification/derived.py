"""What `verify --derived` shows: the derivation proved for all i, m, n and k, and its tables found by other routes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from textwrap import wrap
from typing import NamedTuple

from flint import fmpq

from wavesym.derivation.delay import delay_equations
from wavesym.derivation.increments import Increment, add, trimmed
from wavesym.derivation.recurrence import recurrence
from wavesym.derivation.table import Function, Table, full_table
from wavesym.derivation.walks import Letters, departures, function_walks, letters, units, walks_until
from wavesym.documents.derivation.families import solved
from wavesym.documents.derivation.highest_powers import POWERS as FAMILIES
from wavesym.documents.derivation.patterns import patterns, rates
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters, System
from wavesym.systems import presets
from wavesym.verification.arguments import (
    NODE_LAW,
    PHYSICAL_TIME,
    POWERS,
    RECURRENCES,
    WALKS,
    Theorem,
    arrangements,
    determinants,
    rates_met,
)
from wavesym.verification.expansion import expanded
from wavesym.verification.node_law import differences
from wavesym.verification.powers import steps
from wavesym.verification.proofs import node_law
from wavesym.verification.theorem import residuals as left_over

INTERVALS = 5
_WIDTH = 110
_INDENT = " " * 6
_SHOWN = 3
_NUMBERS: dict[str, Callable[[int], fmpq]] = {
    "kappa": lambda i: fmpq(2 * i + 1, i + 4),
    "inertia": lambda i: fmpq(i + 4, 2 * i + 3),
    "velocity": lambda i: fmpq(5, i + 1) - i,
    "dashpot": lambda i: fmpq(1, i + 5),
}


class Proof(NamedTuple):
    """A theorem for a system: of what of it, what the proof went through, how often it was asked, where it fails."""

    theorem: Theorem
    of: str
    through: str
    asked: int
    failed: tuple[str, ...]

    @property
    def holds(self) -> bool:
        """Whether it was asked, and held each time."""
        return self.asked > 0 and not self.failed


def derived(watch: Callable[[list[System]], Iterable[System]] = iter) -> tuple[str, bool]:
    """Every theorem with its argument and its proofs, and whether all hold.

    `watch` goes through the systems as they are proved.
    """
    systems = [system for preset in presets().values() for system in (*preset.variants, *preset.beside)]
    proofs = [proof for system in watch(systems) for proof in (*_proofs(system), *_routes(system))]
    theorems = dict.fromkeys(proof.theorem for proof in proofs)
    lines = (line for theorem in theorems for line in _told(theorem, [p for p in proofs if p.theorem is theorem]))
    return "\n".join(lines), all(proof.holds for proof in proofs)


def _told(theorem: Theorem, proofs: Iterable[Proof]) -> Iterator[str]:
    yield theorem.claim
    yield from wrap(theorem.argument, _WIDTH, initial_indent="  ", subsequent_indent="  ")
    for proof in proofs:
        held = proof.asked - len(proof.failed)
        yield f"  {'PASS' if proof.holds else 'FAIL'}  {proof.of}: {held} of {proof.asked} {theorem.counted}"
        yield from wrap(proof.through, _WIDTH, initial_indent=_INDENT, subsequent_indent=_INDENT)
        yield from (f"{_INDENT}Not so: {where}" for where in proof.failed[:_SHOWN])
    yield ""


def sample(system: System, m: int) -> Chain:
    """A chain in which all parameters are different."""
    numbers = {name: {i: _NUMBERS[name](i) for i in indices} for name, indices in system.indices(m).items()}
    return Chain(system, m, Parameters(**numbers))


def _proofs(system: System) -> Iterator[Proof]:
    """For symbolic i, m, n, k and parameters."""
    waves = list(node_law(system, delay_equations(system)))
    unlike = tuple(
        f"{wave.function} of rod {wave.rod} differs by {wave.difference}"
        for wave in waves
        if wave.difference != 0 or 0 in wave.determinants
    )
    yield Proof(NODE_LAW, system.name, determinants(waves), len(waves), unlike)
    for pattern in patterns(system):
        laws = recurrence(system, pattern.parameters)
        known = rates(laws.laws)
        left = [
            (e, residual)
            for found in (None, known)
            for e, law in zip(delay_equations(system, pattern.parameters), laws.laws, strict=True)
            for residual in left_over(e, solved(law, found), laws.interval)
        ]
        unsolved = tuple(f"the equation of {e.function} of rod {e.rod} leaves {rest}" for e, rest in left if rest != 0)
        yield Proof(RECURRENCES, f"{system.name}, {pattern.name}", rates_met(laws, known), len(left), unsolved)
    for family in FAMILIES.get(system.name, ()):
        made = list(steps(system, family))
        beyond = tuple(
            f"{step.of}, {step.because}, {step.where}: {step.slack} is not at least 0"
            for step in made
            if not step.holds
        )
        of = f"{system.name}, {family.of.replace('$', '')}"
        yield Proof(POWERS, of, arrangements(family, made), len(made), beyond)


def _routes(system: System) -> Iterator[Proof]:
    """The exact tables of small chains, by other routes."""
    chains = [sample(system, m) for m in (system.smallest, system.smallest + system.step)]
    tables = [full_table(chain, INTERVALS, fmpq(0)) for chain in chains]
    gains = sum(len(gained) for made in tables for response in made.responses.values() for gained in response.values())
    routes: Sequence[tuple[Theorem, Callable[[Chain, Table], Iterable[object]]]] = (
        (PHYSICAL_TIME, differences),
        (WALKS, _unlike_walks),
    )
    for theorem, wrong in routes:
        found = tuple(
            f"m = {chain.m}: {one}" for chain, made in zip(chains, tables, strict=True) for one in wrong(chain, made)
        )
        of = f"{system.name}, m = {chains[0].m} and {chains[1].m}, {INTERVALS} intervals"
        yield Proof(theorem, of, "", gains, found)


def _unlike_walks(chain: Chain, made: Table) -> Iterator[Function]:
    """A function for each interval in which its increment is not that of its walk polynomial."""
    for source, response in by_walks(chain, made, INTERVALS, letters(chain)).items():
        for function, gains in response.items():
            for ours, theirs in zip(gains, made.responses[source][function], strict=True):
                if ours != theirs:
                    yield function


def by_walks(chain: Chain, made: Table, intervals: int, names: Letters) -> dict[str, dict[Function, list[Increment]]]:
    """The responses of a table from walk polynomials in the letters `names`, the contacts of an impact summed."""
    responses: dict[str, dict[Function, list[Increment]]] = {
        source: {function: [{} for _ in gains] for function, gains in response.items()}
        for source, response in made.responses.items()
    }
    for unit in units(chain):
        sent = walks_until(chain, unit, departures(chain, made.interval, intervals), names, names.symbols)
        response = responses["impact" if unit.name.startswith("impact") else unit.name]
        for function, gains in response.items():
            for n, gain in enumerate(gains, 1):
                polynomial = function_walks(chain, sent, function, n, made.interval)
                add(gain, expanded(polynomial, unit, names))
    return {source: {f: list(map(trimmed, gains)) for f, gains in r.items()} for source, r in responses.items()}
