"""Every program and every check on every scene: a table for each, and one verdict."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from wavesym.exact.contacts.events import events
from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest
from wavesym.programs.request import Request
from wavesym.running.toolchain import CompilerError, compiler
from wavesym.scene import Scene
from wavesym.verification.checks import CHECKS
from wavesym.verification.independent import independent_model
from wavesym.verification.integrations import elements
from wavesym.verification.outcome import REFUSED, IntegratedOutput, Outcome, Row, table
from wavesym.verification.programs import compare_programs
from wavesym.verification.reference import ReferenceOutputs, known_outputs, unknown_outputs
from wavesym.verification.stretches import PARTS, stretches, unseen_stretches

_LATE = 0.05  # parts of the horizon that an integration may leave out at its end
_MOST_TOLD = 3  # stretches without values
_LEGEND = "Errors are relative to the output's largest value."
_PROGRAMS = (
    "Programs, each in the output in which it is worst: its error against exact values (ball arithmetic rounded\n"
    "once), its difference from an integration, what that may be wrong by, and the bound that the program states\n"
    "(for parameters and loads at run time: the estimate):"
)


def verify(scenes: Iterable[tuple[Scene, Model]], requests: Sequence[Request] | None = None) -> tuple[str, bool]:
    """For each check a table of what it found for every scene, and whether all errors are within what is allowed.

    Without `requests` all programs that serve a scene and all checks; else these programs, and no more than is needed
    to compare them with an integration. An output that no integration judges, or of no program, fails.
    """
    rows: list[list[Row]] = [[] for _ in range(1 + len(CHECKS))]
    notes: list[str] = []
    passed = True

    def add_rows(number: int, name: str, column: str, outcomes: Iterable[Outcome]) -> None:
        nonlocal passed, notes
        for outcome in outcomes:
            rows[number].append({"scene": name, column: outcome.subject, **outcome.cells, "verdict": outcome.verdict})
            notes += [outcome.note] if outcome.note else []
            passed = passed and outcome.passed

    for scene, model in scenes:
        own = independent_model(scene, model)
        truth = known_outputs(model, own) if model.damping is None else unknown_outputs(model, own)
        notes += truth.notes
        found: dict[str, list[IntegratedOutput]] = {}
        for number, check in enumerate(CHECKS, 1):
            if (truth.outputs or check.run is elements) and not (
                requests is not None and len(found) == len(model.probes)
            ):
                outcomes = check.run(truth)
                add_rows(number, model.name, "of", outcomes)
                for each in outcomes:
                    if each.integral and _judges(each.integral, truth):
                        found.setdefault(each.subject, []).append(each.integral)
        judges = [found.get(probe.name, []) for probe in model.probes]
        integrals = [next(iter(each), None) for each in judges]
        compared = compare_programs(scene, truth, integrals, requests)
        add_rows(0, model.name, "program", compared)
        add_rows(0, model.name, "program", _unjudged_outputs(model, integrals, compared))
        add_rows(0, model.name, "program", unseen_outputs(truth, judges))
    lines = [_LEGEND, _compiler(), *dict.fromkeys(notes), ""]
    for title, of_check in zip((_PROGRAMS, *(check.title for check in CHECKS)), rows, strict=True):
        if of_check:
            lines += [title, "", *table(of_check, ("scene", "program", "of", "verdict")), ""]
    return "\n".join(lines[:-1]) + "\n", passed


def _judges(integral: IntegratedOutput, truth: ReferenceOutputs) -> bool:
    """Whether it can tell what is wrong from what is right: of what is still 0 only at the end of the horizon."""
    moves = integral.size > integral.error_bound
    return integral.judges and (moves or integral.taus[-1] >= truth.whole.horizon() * (1 - _LATE))


def _unjudged_outputs(
    model: Model, integrals: Sequence[IntegratedOutput | None], compared: Sequence[Outcome]
) -> list[Outcome]:
    """A row that fails for each output that nothing judges, and for a scene that no program serves."""
    found = []
    for probe, integral in zip(model.probes, integrals, strict=True):
        if integral is None:
            why = f"{model.name}: {probe.name} is not verified, as no integration is exact enough to judge it"
            found.append(Outcome("none", {"of": probe.name, "error": "not seen"}, False, why))
    if all(REFUSED in outcome.cells.values() for outcome in compared):
        found.append(Outcome("none", {"of": "-", "error": "refused"}, False, f"{model.name}: no program is verified"))
    return found


def unseen_outputs(truth: ReferenceOutputs, judges: Sequence[Sequence[IntegratedOutput]]) -> list[Outcome]:
    """A row without a verdict for each output that integrations judge, but not in all stretches between what happens.

    Args:
        truth: what is known of the scene.
        judges: what integrations have of each output.
    """
    model, until = truth.model, truth.until
    happened = [event.double for event in events(model)] if truth.outputs else []
    parts = stretches(until, [*happened, *(nearest(load.time) for load in model.loads)])
    found = []
    for probe, integrals in zip(model.probes, judges, strict=True):
        taus = np.unique([tau for each in integrals for tau in each.taus])
        if integrals and (unseen := unseen_stretches(parts, taus)):
            where = ", ".join(f"{begin:.4g} to {end:.4g}" for begin, end in unseen[:_MOST_TOLD])
            more = f" and {len(unseen) - _MOST_TOLD} more" if len(unseen) > _MOST_TOLD else ""
            note = (
                f"{model.name}: {probe.name} is verified in part, as no integration has values of it in {len(unseen)} "
                f"of {len(parts)} stretches between events, loads and tenths of the time: tau = {where}{more} "
                f"(stretches up to {until / PARTS:.2g} are not looked into)"
            )
            found.append(Outcome("none", {"of": probe.name, "error": "in part"}, True, note, decided=False))
    return found


def _compiler() -> str:
    try:
        return f"The C compiler is {compiler().version}."
    except CompilerError as error:
        return f"C was not tried: {error}."
