"""Waves on windows: the node law run in power series, in balls, without rates, partial fractions or tables.

In physical time every node needs only waves that were sent one unit earlier, so that on a unit window all nodes are
independent of each other (numerics, sections 1 and 4). Inside a window waves are smooth between the fractional parts of
the load times; there it is cut into panels. On a panel, in u = tau - (its start), a wave is a polynomial in balls plus
a function that is nowhere larger than `error`: with arriving waves a, b and the load's polynomial,

    same q_k + raised(k) q_(k+1) = r_k,  r = left a + right b + load,  q_0 continuous,

as it is derived (`derivation.recurrence`), and what is cut off after N terms leaves a defect same q_(N-1) u**(N-1). As
same >= 0, the error of q is at most that
at the start, and (error of r + defect) / same where that is more.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

from flint import arb, arb_poly, ctx, fmpq, fmpq_poly

from wavesym.errors import CostError
from wavesym.exact.node_rules import node_rule
from wavesym.model.chain import Chain
from wavesym.model.loads import Applied
from wavesym.model.node import Node, Rod

_LARGEST = 5 << 27  # bytes


class PanelWave(NamedTuple):
    """A function on a panel: |function - polynomial| <= error."""

    polynomial: arb_poly
    error: arb

    def at(self, u: fmpq) -> arb:
        """An enclosure of its value."""
        value = self.polynomial(arb(u))
        return value if self.error == 0 else value + arb(0, self.error)


STILL = PanelWave(arb_poly(), arb(0))


class WindowPanel(NamedTuple):
    """A part of every unit window: from n + start on, `length` long."""

    start: fmpq
    length: fmpq


@dataclass(frozen=True)
class Windows:
    """The waves that nodes send: `left[x][n * len(panels) + j]` on panel j of the window [n, n + 1).

    Before tau = 0 a rod holds half its velocity in each of its waves. Only nodes in `nodes` are modelled.
    """

    chain: Chain
    nodes: range
    panels: tuple[WindowPanel, ...]
    left: dict[int, list[PanelWave]]
    right: dict[int, list[PanelWave]]

    @cached_property
    def _starts(self) -> list[fmpq]:
        return [panel.start for panel in self.panels]

    def sent(self, direction: str, x: int, tau: fmpq) -> tuple[PanelWave, fmpq]:
        """The wave that the node at x sends "left" or "right" at tau and just after, and where in it tau is."""
        window = tau.floor()
        if window < 0:
            rod = self.chain.rod(x + 1 if direction == "right" else x)
            return _constant(rod.velocity / 2), fmpq(0)
        place = bisect_right(self._starts, tau - window) - 1
        waves = self.right[x] if direction == "right" else self.left[x]
        return waves[int(window) * len(self.panels) + place], tau - window - self._starts[place]


def windows(chain: Chain, nodes: range, loads: Sequence[Applied], count: int, terms: int, bits: int) -> Windows:
    """The waves of a chain on the windows [0, 1), ... [count - 1, count), in `terms` terms with so many bits.

    What reaches the first and last of `nodes` from outside must not matter. CostError where they would fill the memory.
    """
    forces = _NodeLoads(chain, nodes, loads)
    panels = panels_of(chain, nodes, loads)
    if (size := stored(2 * len(nodes) * count * len(panels), terms, bits)) > _LARGEST:
        raise CostError(
            f"output.until: the waves of {len(nodes)} nodes on {count} windows with {bits} bits would take "
            f"{size:.1e} bytes, at most {_LARGEST:.1e} expected (a shorter horizon or fewer load times help)"
        )
    with ctx.workprec(bits):
        return _marched(chain, nodes, panels, forces, count, terms)


def _marched(
    chain: Chain, nodes: range, panels: tuple[WindowPanel, ...], forces: _NodeLoads, count: int, terms: int
) -> Windows:
    result = Windows(chain, nodes, panels, {x: [] for x in nodes}, {x: [] for x in nodes})
    bodies = {x: _Body(chain.nodes[x]) for x in nodes}
    for step in range(count * len(panels)):
        n, place = divmod(step, len(panels))
        panel = panels[place]
        for x in nodes:
            node = chain.nodes[x]
            a = _arriving(result.right, x - 1, node.left, step - len(panels))
            b = _arriving(result.left, x + 1, node.right, step - len(panels))
            load = forces.on(x, n + panel.start)
            q = bodies[x].moved(a, b, load, panel.length, terms)
            result.left[x].append(PanelWave(q.polynomial - a.polynomial, q.error + a.error))
            result.right[x].append(PanelWave(q.polynomial - b.polynomial, q.error + b.error))
    return result


def stored(waves: int, terms: int, bits: int) -> int:
    """About how many bytes so many waves take: of each power middle and radius, and the words of the middle."""
    return waves * terms * (48 + bits // 8)


def _constant(value: fmpq) -> PanelWave:
    return PanelWave(arb_poly([arb(value)]), arb(0)) if value != 0 else STILL


def _arriving(sent: dict[int, list[PanelWave]], x: int, rod: Rod | None, step: int) -> PanelWave:
    if rod is None:
        return STILL
    if step < 0 or x not in sent:
        return _constant(rod.velocity / 2)
    return sent[x][step]


def panels_of(chain: Chain, nodes: range, loads: Iterable[Applied]) -> tuple[WindowPanel, ...]:
    """The parts of a window between the instants of the loads on `nodes`."""
    acting = {load.source for x in nodes for load in chain.nodes[x].loads}
    times = (load.time for load in loads if load.source in acting)
    cuts = sorted({fmpq(0), fmpq(1)} | {time - time.floor() for time in times})
    return tuple(WindowPanel(low, high - low) for low, high in pairwise(cuts))


class _Body:
    """A node in motion: its law, and its velocity at the end of the last panel."""

    def __init__(self, node: Node) -> None:
        rule = node_rule(node)
        self._left, self._right, self._load = arb(rule.left), arb(rule.right), arb(rule.load)
        self._same = arb(rule.same)
        self._raised = rule.raised
        self._q = _constant(node.velocity)
        self._start = self._q.at(fmpq(0))

    def moved(self, a: PanelWave, b: PanelWave, load: arb_poly, length: fmpq, terms: int) -> PanelWave:
        """The velocity on the next panel."""
        right = self._left * a.polynomial + self._right * b.polynomial + self._load * load
        error = self._left * a.error + self._right * b.error
        if not any(self._raised):
            return PanelWave(right * (1 / self._same), _upper(error / self._same))
        if right.length() == 0 and error == 0 and self._start.is_zero():
            return STILL
        coefficients = [self._start]
        given = right.coeffs()
        given += [arb(0)] * (terms - len(given))
        last = self._start
        same, (constant, slope) = self._same, self._raised
        for k in range(terms - 1):
            last = (given[k] - same * last) / arb(constant + slope * k)
            coefficients.append(last)
        # what the series does not balance: the last power of gamma q, and powers of r that it does not reach
        defect = (given[terms - 1] - same * last) * arb(length) ** (terms - 1)
        wave = PanelWave(arb_poly(coefficients), _upper((error + abs(defect)) / same))
        self._start = wave.at(length)
        return wave


def _upper(value: arb) -> arb:
    """The largest number in a ball, without a radius."""
    return value.upper() if value != 0 else arb(0)


class _NodeLoads:
    """The loads on the nodes, as polynomials in the time since the start of a panel; panels come in order."""

    def __init__(self, chain: Chain, nodes: range, loads: Sequence[Applied]) -> None:
        self._coming: dict[int, list[tuple[fmpq, fmpq_poly]]] = defaultdict(list)
        self._acting: dict[int, tuple[fmpq, fmpq_poly]] = {}
        units = defaultdict(list)
        for x in nodes:
            for unit in chain.nodes[x].loads:
                units[unit.source].append((x, fmpq_poly(list(unit.coefficients))))
        for load in sorted(loads, key=lambda load: load.time, reverse=True):
            for x, polynomial in units[load.source]:
                self._coming[x].append((load.time, load.weight * polynomial))

    def on(self, x: int, start: fmpq) -> arb_poly:
        """The load on the node at x from tau = start on."""
        if x not in self._coming:
            return arb_poly()
        since, total = self._acting.get(x, (start, fmpq_poly()))
        total = total(fmpq_poly([start - since, 1]))
        while self._coming[x] and self._coming[x][-1][0] <= start:
            total += self._coming[x].pop()[1]
        self._acting[x] = start, total
        return arb_poly([arb(c) for c in total.coeffs()])
