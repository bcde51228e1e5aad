"""Modal systems made without the package: a building of finite elements, oscillators of all kinds, one storey.

And what they do, by the exponential of a matrix: loads that are linear in time are states of their own.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from flint import fmpq
from scipy.linalg import eigh, expm

from tests.support.assembly import exact
from wavesym.numbers.reals import DOUBLE, Real
from wavesym.programs.modes.evaluator import ModesEvaluator
from wavesym.programs.modes.loads import LinearLoads
from wavesym.programs.modes.modal_system import ModalSystem
from wavesym.programs.program import Input, ProgramOutput

RECORD = Path(__file__).parents[2] / "examples" / "records" / "elcentro_1940_ns_peknold.csv"
"""El Centro as published: times in s, accelerations in g, from (0, 0) on."""

INCHES_OF_G = 386.0886
"""g in in/s^2"""


def el_centro() -> list[fmpq]:
    """The samples of the record, exact, 0.02 s apart."""
    rows = [line.split(",") for line in RECORD.read_text().splitlines() if line[0].isdigit()]
    return [exact(row[1]) for row in rows]


def storeys(m: int, elements: int, damping: float, mass: float = 30.0) -> ModalSystem:
    """m equal storeys on moving ground, of so many elements each: drifts, velocities and displacements of floors."""
    count = m * elements
    stiffness, masses = np.zeros((2, count + 1, count + 1))
    for e in range(count):
        stiffness[e : e + 2, e : e + 2] += elements * np.array([[1, -1], [-1, 1]])
        masses[e : e + 2, e : e + 2] += np.array([[2, 1], [1, 2]]) / (6 * elements)
    floors = elements * np.arange(1, m + 1)
    masses[floors, floors] += mass
    squares, shapes = eigh(stiffness[1:, 1:], masses[1:, 1:])
    at = np.vstack([np.zeros(count), shapes])[[0, *floors]]
    pushes = -shapes.T @ masses[1:].sum(axis=1)
    zero = np.zeros((m, count))
    direct = np.zeros((3 * m, 1, 3))
    direct[m : 2 * m, 0, 1] = direct[2 * m :, 0, 2] = 1
    return ModalSystem(
        np.sqrt(squares),
        np.full(count, damping),
        pushes[:, None],
        np.vstack([np.diff(at, axis=0), zero, at[1:]]),
        np.vstack([zero, at[1:], zero]),
        direct,
    )


def oscillators(frequency, damping, loads: int, outputs: int, seed: int = 0) -> ModalSystem:
    """Any oscillators, with loads and outputs that mix all of them."""
    draw = np.random.default_rng(seed).uniform
    count = len(frequency)
    return ModalSystem(
        np.array(frequency, float),
        np.array(damping, float),
        draw(-1, 1, (count, loads)),
        draw(-1, 1, (outputs, count)),
        draw(-1, 1, (outputs, count)),
        draw(-1, 1, (outputs, loads, 3)),
    )


def uniform(samples, spacing: fmpq) -> LinearLoads:
    """One load with samples from tau = 0 on, the last of which stays."""
    times = tuple(spacing * k for k in range(len(samples)))
    return LinearLoads(times, tuple((exact(sample),) for sample in samples), (fmpq(0),))


def evaluator(system: ModalSystem, loads: LinearLoads, until: float, real: Real = DOUBLE) -> ModesEvaluator:
    """The program of a system as it stands: its errors are those of rounding. A stream counts load 0 in -2/3 N."""
    first, *others = (f"load{j}" for j in range(system.pushes.shape[1]))
    inputs = (Input(first, fmpq(-3, 2), "N"), *(Input(name, fmpq(1), "") for name in others))
    made = ModesEvaluator(system, loads, loads.spacing(exact(until)), real, until, inputs)
    errors, largest = made.rounding
    outputs = (
        ProgramOutput(f"displacement@{k}", error / size, size)
        for k, (error, size) in enumerate(zip(errors.tolist(), largest.tolist(), strict=True))
    )
    return replace(made, outputs=tuple(outputs))


def by_exponentials(system: ModalSystem, loads: LinearLoads, tau: float) -> np.ndarray:
    """The outputs at one tau: states are y, v, and of each load its slope, itself and two integrals."""
    count, number = system.pushes.shape
    size = 2 * count + 4 * number
    rates = np.zeros((size, size))
    y, v = np.arange(count), count + np.arange(count)
    slope, load, once, twice = (2 * count + k * number + np.arange(number) for k in range(4))
    rates[y, v] = rates[load, slope] = rates[once, load] = rates[twice, once] = 1
    rates[v, y], rates[v, v] = -(system.frequency**2), -2 * system.damping * system.frequency
    rates[v[:, None], load] = system.pushes
    state = np.zeros(size)
    times = [float(time) for time in loads.times]
    samples = np.array([[float(value) for value in row] for row in loads.samples])
    state[load] = samples[0]
    for k, time in enumerate(times):
        if time >= tau:
            break
        last = k + 1 == len(times)
        end = tau if last else min(times[k + 1], tau)
        state[slope] = (
            [float(s) for s in loads.slopes] if last else (samples[k + 1] - samples[k]) / (times[k + 1] - time)
        )
        state = expm(rates * (end - time)) @ state
    outputs = system.displacement_weights @ state[y] + system.velocity_weights @ state[v]
    return outputs + np.einsum("ojk,kj->o", system.direct, state[np.stack([load, once, twice])])
