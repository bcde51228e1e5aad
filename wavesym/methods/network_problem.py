"""The problem of a model: its network and loads in doubles, for methods that support what it has."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from flint import fmpq

from wavesym.errors import UnservedError
from wavesym.mechanics.model import Model
from wavesym.mechanics.network import Link, Network
from wavesym.methods.problem import LOAD_TERMS, LoadEvent, Problem
from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import fraction, nearest

# a grid of steps that all delays are multiples of has at most so many in the longest
_MOST_STEPS = 200

_SHAPES = fmpq(1, 10**4)
"""The tolerance of straight lines in place of a shape: what other methods are compared for is less sharp."""


def network_problem(model: Model) -> Problem:
    """State the problem of a model, contacts and modal damping included.

    Of links with other laws that have corners it has the dashpots alone, as far as they act all the time. Loads of a
    shape are straight lines.
    """
    model = model.straighten(_SHAPES)
    network = model.network
    points, bars = network.points, network.bars
    damping, stiffness = (np.diag(_numbers(points, name)) for name in ("damping", "stiffness"))
    gaps, parting = [], []
    for link in network.links:
        pair = opening(network, link)
        if link.contact:
            gaps.append(nearest(link.gap))
            parting.append(pair)
            continue
        damping = damping + nearest(link.steady_damping) * np.outer(pair, pair)
        if not link.has_corner:
            stiffness = stiffness + nearest(link.stiffness) * np.outer(pair, pair)
    events = tuple(_load_events(model))
    velocity = np.array([nearest(_start_velocity(network, number)) for number in range(len(points))])
    prescribed = tuple(number for number, point in enumerate(points) if point.motion)
    for number in prescribed:
        velocity[number] = sum(event.coefficients[0] for event in events if event.point == number and event.time == 0)
    return Problem(
        mass=_numbers(points, "mass"),
        damping=damping,
        stiffness=stiffness,
        velocity=velocity,
        prescribed_points=prescribed,
        ground=next((number for number in prescribed if points[number].motion != "fixed"), 0),
        ends=np.array([(bar.left, bar.right) for bar in bars], dtype=int).reshape(-1, 2),
        ratios=np.array([[nearest(ratio) for ratio in bar.ratios] for bar in bars]).reshape(-1, 2),
        delays=tuple(fraction(bar.delay) for bar in bars),
        speed=_numbers(bars, "speed"),
        impedance=_numbers(bars, "impedance"),
        start_velocity=_numbers(bars, "velocity"),
        start_strain=_numbers(bars, "strain"),
        start_slope=_numbers(bars, "initial_slope"),
        gravity=_numbers(bars, "gravity"),
        gaps=np.array(gaps),
        parting=np.array(parting).reshape(-1, len(points)),
        events=events,
        probes=model.probes,
        until=nearest(model.until),
        modal=model.damping,
    )


def opening(network: Network, link: Link) -> Array:
    """How much longer a link gets where each point moves by 1: (points,)."""
    pair = np.zeros(len(network.points))
    pair[link.left], pair[link.right] = -nearest(link.ratio), 1.0
    return pair


def linear_problem(model: Model) -> Problem:
    """State the problem of a model without corners, modal damping included.

    Raises:
        UnservedError: contacts open and close, or other links have laws with corners.
    """
    for number in model.network.corners:
        raise UnservedError(
            f"system: {model.network.links[number].changes}, which other methods do not support; take pieces or `run`"
        )
    model.network.refuse_dead_loads()
    return network_problem(model)


def undamped_problem(model: Model) -> Problem:
    """State the problem of a model for methods that know no modes, and have no accelerations.

    Raises:
        UnservedError: there are no rods, contacts open and close, modes are damped, or what has no mass is accelerated.
    """
    model.refuse_damping()
    model.network.refuse_rodless("this method", "write one")
    problem = linear_problem(model)
    if any(reading.order > 0 for reading in problem.readings):
        raise UnservedError("output.acceleration: other methods support no place without mass; write one with mass")
    return problem


def gridded_problem(model: Model) -> Problem:
    """State the problem of a model for methods whose steps divide all delays.

    Raises:
        UnservedError: as `undamped_problem`, and where the delays have no common measure that is long enough.
    """
    problem = undamped_problem(model)
    if (steps := max(problem.delays) / problem.measure) > _MOST_STEPS:
        raise UnservedError(
            f"system: delays of rods have a common measure of 1/{float(steps):.3g} of the longest; write lengths "
            f"with one of 1/{_MOST_STEPS} or more"
        )
    return problem


def _start_velocity(network: Network, number: int) -> fmpq:
    """The velocity of a point at tau = 0; that of one without mass is what balances the momentum of its bars."""
    point = network.points[number]
    momentum = weight = fmpq(0)
    for bar, side in network.ends_at.get(number, ()):
        ratio, impedance = network.bars[bar].ratios[side], network.bars[bar].impedance
        momentum += ratio * impedance * network.bars[bar].velocity
        weight += ratio**2 * impedance
    return momentum / weight if point.mass == 0 and weight != 0 else point.velocity


def _load_events(model: Model) -> Iterator[LoadEvent]:
    """The loads; for a prescribed motion its velocity, which begins as the point's own."""
    units = {}
    for number, point in enumerate(model.network.points):
        if point.motion and point.velocity != 0:
            yield LoadEvent(fraction(fmpq(0)), number, _coefficients([point.velocity]))
        for unit in point.loads:
            integrated = [fmpq(0), *(fmpq(c) / (k + 1) for k, c in enumerate(unit.coefficients))]
            units[unit.source] = number, integrated if point.motion == "acceleration" else unit.coefficients
    for load in model.loads:
        if load.source in units:  # an impact is in the velocities
            number, coefficients = units[load.source]
            yield LoadEvent(fraction(load.time), number, _coefficients([load.weight * c for c in coefficients]))


def _coefficients(exact: Sequence[fmpq]) -> tuple[float, float, float]:
    """The coefficients of a load, as many as every load has."""
    a, b, c = map(nearest, (*exact, *[fmpq(0)] * (LOAD_TERMS - len(exact))))
    return a, b, c


def _numbers(parts: Sequence[object], name: str) -> Array:
    return np.array([nearest(getattr(part, name)) for part in parts])
