"""What `verify --derived` shows: the derivation proved for all i, m, n and k, and its tables found by other routes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from flint import fmpq

from wavesym.derivation.delay import delay_equations
from wavesym.derivation.recurrence import recurrence
from wavesym.documents.derivation.families import solved
from wavesym.documents.derivation.highest_powers import POWERS
from wavesym.documents.derivation.patterns import patterns, rates
from wavesym.exact.increments import Increment, add, trimmed
from wavesym.exact.table import Function, Table, full_table
from wavesym.exact.walks import Letters, departures, function_walks, letters, units, walks_until
from wavesym.model.chain import Chain
from wavesym.model.node import Parameters, System
from wavesym.systems import PRESETS
from wavesym.verification.columns import Row, table
from wavesym.verification.expansion import expanded
from wavesym.verification.node_law import differences
from wavesym.verification.powers import steps
from wavesym.verification.proofs import node_law
from wavesym.verification.substitution import jumps, residuals
from wavesym.verification.theorem import residuals as left_over

INTERVALS = 5
_NUMBERS: dict[str, Callable[[int], fmpq]] = {
    "kappa": lambda i: fmpq(2 * i + 1, i + 4),
    "inertia": lambda i: fmpq(i + 4, 2 * i + 3),
    "velocity": lambda i: fmpq(5, i + 1) - i,
    "dashpot": lambda i: fmpq(1, i + 5),
}


class ProvedClaim(NamedTuple):
    """A claim about a system; how often it was to hold, and how often it does."""

    system: str
    claim: str
    asked: int
    held: int


def derived(watch: Callable[[list[System]], Iterable[System]] = iter) -> tuple[str, bool]:
    """A line for every claim, and whether all hold. `watch` goes through the systems as they are proved."""
    systems = [system for preset in PRESETS.values() for system in preset.variants]
    claims = [claim for system in watch(systems) for claim in (*_proofs(system), *_routes(system))]
    rows: list[Row] = [
        {
            "system": claim.system,
            "claim": claim.claim,
            "asked": str(claim.asked),
            "held": str(claim.held),
            "verdict": "PASS" if claim.asked == claim.held > 0 else "FAIL",
        }
        for claim in claims
    ]
    return "\n".join(table(rows, ("system", "claim", "verdict"))) + "\n", all(row["verdict"] == "PASS" for row in rows)


def sample(system: System, m: int) -> Chain:
    """A chain in which all parameters are different."""
    numbers = {name: {i: _NUMBERS[name](i) for i in indices} for name, indices in system.indices(m).items()}
    return Chain(system, m, Parameters(**numbers))


def _proofs(system: System) -> Iterator[ProvedClaim]:
    """For symbolic i, m, n, k and parameters."""
    waves = list(node_law(system, delay_equations(system)))
    right = sum(wave.difference == 0 and all(d != 0 for d in wave.determinants) for wave in waves)
    yield ProvedClaim(system.name, "the delay equations are the node law", len(waves), right)
    for pattern in patterns(system):
        laws = recurrence(system, pattern.parameters)
        left = [
            residual
            for found in (None, rates(laws.laws))
            for e, law in zip(delay_equations(system, pattern.parameters), laws.laws, strict=True)
            for residual in left_over(e, solved(law, found), laws.interval)
        ]
        held = sum(residual == 0 for residual in left)
        yield ProvedClaim(system.name, f"the recurrences solve the delay equations: {pattern.name}", len(left), held)
    for family in POWERS.get(system.name, ()):
        made = list(steps(system, family))
        of = family.of.replace("$", "")
        yield ProvedClaim(system.name, f"no power is higher: {of}", len(made), sum(step.holds for step in made))


def _routes(system: System) -> Iterator[ProvedClaim]:
    """The exact tables of small chains."""
    for m in (system.smallest, system.smallest + system.step):
        chain = sample(system, m)
        made = full_table(chain, INTERVALS, fmpq(0))
        gains = sum(len(gained) for response in made.responses.values() for gained in response.values())
        for route, wrong in (
            ("put back into the delay equations", residuals),
            ("bodies' velocities without jumps", jumps),
            ("from the node law, in physical time", differences),
            ("from walk polynomials", _unlike_walks),
        ):
            name = f"tables, m = {m}, {INTERVALS} intervals: {route}"
            yield ProvedClaim(system.name, name, gains, gains - sum(1 for _ in wrong(chain, made)))


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
