"""What `verify --derived` shows: the derivation proved for all i, m, n and k, and its tables found by another route."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from textwrap import wrap
from typing import NamedTuple

from flint import fmpq

from wavesym.derivation.delay import delay_equations
from wavesym.derivation.recurrence import recurrence
from wavesym.derivation.table import full_table
from wavesym.documents.derivation.families import solve_at_rates
from wavesym.documents.derivation.highest_powers import POWERS as FAMILIES
from wavesym.documents.derivation.patterns import patterns, rates
from wavesym.mechanics.chain import Chain
from wavesym.mechanics.node import Parameters, System
from wavesym.systems import presets
from wavesym.verification.arguments import (
    NODE_LAW,
    POWERS,
    RECURRENCES,
    WALKS,
    Theorem,
    arrangements,
    determinants,
    rates_met,
)
from wavesym.verification.powers import steps
from wavesym.verification.proofs import node_law
from wavesym.verification.theorem import residuals
from wavesym.verification.walks import differences

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
    """A theorem for a system: of what of it, what the proof went through, how many cases it has, where it fails."""

    theorem: Theorem
    subject: str
    route: str
    cases: int
    failures: tuple[str, ...]

    @property
    def holds(self) -> bool:
        """Whether there were cases, and it held in each."""
        return self.cases > 0 and not self.failures


def derivation_report(watch: Callable[[list[System]], Iterable[System]] = iter) -> tuple[str, bool]:
    """Every theorem with its argument and its proofs, and whether all hold.

    `watch` goes through the systems as they are proved.
    """
    systems = [system for preset in presets().values() for system in (*preset.variants, *preset.companions)]
    proofs = [proof for system in watch(systems) for proof in (*_proofs(system), _walks(system))]
    theorems = dict.fromkeys(proof.theorem for proof in proofs)
    lines = (line for theorem in theorems for line in _lines(theorem, [p for p in proofs if p.theorem is theorem]))
    return "\n".join(lines), all(proof.holds for proof in proofs)


def _lines(theorem: Theorem, proofs: Iterable[Proof]) -> Iterator[str]:
    yield theorem.claim
    yield from wrap(theorem.argument, _WIDTH, initial_indent="  ", subsequent_indent="  ")
    for proof in proofs:
        held = proof.cases - len(proof.failures)
        yield f"  {'PASS' if proof.holds else 'FAIL'}  {proof.subject}: {held} of {proof.cases} {theorem.count_noun}"
        yield from wrap(proof.route, _WIDTH, initial_indent=_INDENT, subsequent_indent=_INDENT)
        yield from (f"{_INDENT}Not so: {where}" for where in proof.failures[:_SHOWN])
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
            for residual in residuals(e, solve_at_rates(law, found), laws.interval)
        ]
        unsolved = tuple(f"the equation of {e.function} of rod {e.rod} leaves {rest}" for e, rest in left if rest != 0)
        yield Proof(RECURRENCES, f"{system.name}, {pattern.name}", rates_met(laws, known), len(left), unsolved)
    for family in FAMILIES.get(system.name, ()):
        inequalities = list(steps(system, family))
        beyond = tuple(
            f"{step.function}, {step.because}, {step.where}: {step.slack} is not at least 0"
            for step in inequalities
            if not step.holds
        )
        of = f"{system.name}, {family.subject.replace('$', '')}"
        yield Proof(POWERS, of, arrangements(family, inequalities), len(inequalities), beyond)


def _walks(system: System) -> Proof:
    """The exact tables of small chains, from walk polynomials."""
    chains = [sample(system, m) for m in (system.smallest, system.smallest + system.step)]
    tables = [full_table(chain, INTERVALS, fmpq(0)) for chain in chains]
    gains = sum(
        len(gained) for table in tables for response in table.responses.values() for gained in response.values()
    )
    found = tuple(
        f"m = {chain.m}: {one}"
        for chain, table in zip(chains, tables, strict=True)
        for one in differences(chain, table)
    )
    return Proof(WALKS, f"{system.name}, m = {chains[0].m} and {chains[1].m}, {INTERVALS} intervals", "", gains, found)
