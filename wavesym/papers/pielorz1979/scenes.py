"""Counterexamples as scenes: what a reader can run to see one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from flint import fmpq

from wavesym.mechanics.chain import Chain
from wavesym.papers.exact_tables import Exact
from wavesym.papers.pielorz1979.truth import Loads
from wavesym.papers.record import Reproduction
from wavesym.systems.building import BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE


def example(
    exact: Exact, loads: Loads, until: fmpq | int, outputs: Mapping[str, Sequence[str]], command: str, look: str
) -> Callable[[], Reproduction]:
    """A case's example: the chain under its loads as a scene, the command that shows it, and what to look at.

    `outputs` are as in a scene, {"strain": ["1-"]}; `command` has SCENE for the file.
    """
    return lambda: Reproduction(written(exact.chain, loads, until, outputs), command, look)


def written(chain: Chain, loads: Loads, until: fmpq | int, outputs: Mapping[str, Sequence[str]]) -> str:
    """A chain under loads as a scene file."""
    kind, given = _SYSTEMS.get(chain.system, ("building", ("kappa",)))
    lines = ['name = "counterexample"', "", "[system]", f'type = "{kind}"', f"m = {chain.m}"]
    values = {name: sorted(getattr(chain.parameters, name).items()) for name in given}
    lines += [_listed(name, [value for _, value in numbered]) for name, numbered in values.items()]
    if kind == "building":
        base = "ground" if chain.system is BUILDING_GROUND else "force"
        lines.append(f'base = "{base}"')
    for source, pieces in loads.items() if kind != "collision" else ():
        times, weights = [piece.time for piece in pieces], [piece.weight for piece in pieces]
        lines += ["", "[[load]]"]
        if kind == "drive":
            lines += [f"body = {source.removeprefix('M')}", _listed("times", times), _listed("steps", weights)]
        else:
            other = "b" if source == "a" else "a"
            lines += [_listed("times", times), _listed(source, weights), _listed(other, [0] * len(times))]
    lines += ["", "[output]", f'until = "{until}"', *(_listed(name, places) for name, places in outputs.items())]
    return "\n".join(lines) + "\n"


_SYSTEMS = {COLLISION: ("collision", ("kappa", "velocity")), DRIVE: ("drive", ("kappa", "inertia"))}


def _listed(name: str, values: Sequence[object]) -> str:
    quoted = (f'"{value}"' for value in values)
    return f"{name} = [{', '.join(quoted)}]"
