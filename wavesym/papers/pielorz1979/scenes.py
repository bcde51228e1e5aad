"""Counterexamples as scenes: what a reader can run to see one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from flint import fmpq

from wavesym.model.chain import Chain
from wavesym.papers.exact_tables import Exact
from wavesym.papers.pielorz1979.truth import Loads
from wavesym.papers.record import Example
from wavesym.systems.building import BUILDING_GROUND
from wavesym.systems.collision import COLLISION
from wavesym.systems.drive import DRIVE


def example(
    exact: Exact, loads: Loads, until: fmpq | int, outputs: Mapping[str, Sequence[str]], command: str, look: str
) -> Callable[[], Example]:
    """A case's example: the chain under its loads as a scene, the command that shows it, and what to look at.

    `outputs` are as in a scene, {"strain": ["1-"]}; `command` has SCENE for the file.
    """
    return lambda: Example(written(exact.chain, loads, until, outputs), command, look)


def written(chain: Chain, loads: Loads, until: fmpq | int, outputs: Mapping[str, Sequence[str]]) -> str:
    """A chain under loads as a scene file."""
    p = chain.parameters
    lines = ['name = "counterexample"', "", "[system]"]
    if chain.system is COLLISION:
        lines += ['type = "collision"', f"m = {chain.m}", _numbers("kappa", p.kappa), _numbers("velocity", p.velocity)]
    elif chain.system is DRIVE:
        lines += ['type = "drive"', f"m = {chain.m}", _numbers("kappa", p.kappa), _numbers("inertia", p.inertia)]
        for source, pieces in loads.items():
            lines += ["", "[[load]]", f"body = {source.removeprefix('M')}"]
            lines += [_listed("times", [x.time for x in pieces]), _listed("steps", [x.weight for x in pieces])]
    else:
        base = "ground" if chain.system is BUILDING_GROUND else "force"
        lines += ['type = "building"', f"m = {chain.m}", _numbers("kappa", p.kappa), f'base = "{base}"']
        for kind in "ab":
            for piece in loads.get(kind, ()):
                other = "b" if kind == "a" else "a"
                lines += ["", "[[load]]", _listed("times", [piece.time])]
                lines += [_listed(kind, [piece.weight]), _listed(other, [fmpq(0)])]
    lines += ["", "[output]", f'until = "{until}"']
    lines += [f"{name} = [{', '.join(_quoted(place) for place in places)}]" for name, places in outputs.items()]
    return "\n".join(lines) + "\n"


def _numbers(name: str, values: Mapping[int, object]) -> str:
    return _listed(name, [value for _, value in sorted(values.items())])


def _listed(name: str, values: Sequence[object]) -> str:
    return f"{name} = [{', '.join(_quoted(value) for value in values)}]"


def _quoted(value: object) -> str:
    return f'"{value}"'
