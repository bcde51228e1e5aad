"""The modes of a chain with dashpots: complex frequencies w, of motions exp(i w tau) that die away, each proved.

They are the zeros of K(w)'s determinant times the sines of the bars, a function without poles. Those of the same chain
without dashpots are known; from these all are sought at once in doubles by Newton's method, each pushed off by all
others, as zeros of a polynomial are (Aberth, 1973). So none is found twice, also where two meet and leave the same way:
one swings no more, and has become two that creep.

Each is polished in complex balls, and proved: a ball that Newton's method (with all slopes that occur in it) maps into
its inside has one zero. That none is missed is proved where all are counted (damped_spectrum.py). Programs do not
count: what all modes together have is known otherwise, and bounds count what is left of it
(programs/modes/dissipation.py): a mode that was missed makes a bound worse, not wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from flint import acb, arb, ctx

from wavesym.exact.modes.frequencies import bisect_frequencies
from wavesym.exact.modes.resting import resting_modes
from wavesym.exact.modes.shape import FoundModes, Mode, complex_mode, trial
from wavesym.exact.modes.stiffness import HarmonicLaw, Stiffness
from wavesym.exact.modes.turns import absorb, bare_ends
from wavesym.mechanics.network import Network
from wavesym.numbers.arrays import Complex
from wavesym.numbers.doubles import nearest

_BITS = 224
_BALL = 80  # bits of a frequency; what is not known of it grows from row to row
_BITS_A_ROW, _MANY_ROWS = ((3, 2), (6, 4), (12, 4)), 32  # of all, and of a frequency; fewer first where rows are many
_NEWTON = 12
_MEETING = 1e-5  # frequencies that no step tells apart
_BESIDE, _FEW = 1e-9, 64  # modes that are so near each other, and at most how many
SHARP = arb(2) ** -60
"""The radius that points of a shape may have."""
_OFF = 2.0**-30  # a frequency itself tells less of its mode than one near it
_RESTING = 1e-10  # spacings of frequencies from 0: what only dashpots hold may rest anywhere, and that is no mode
_STRAIGHT = 1e-9  # of what creeps, which has no real part
_MORE = 1.15  # as many are sought, as those at the edge are pushed off by fewer
_BARS = 48  # for each of which one more is sought, but of so many
_ROUNDS = 400
_FOUND, _ROUGH = 1e-11, 1e-6  # parts that a last step is of a frequency, and where doubles tell no more
_PATIENT = 60  # rounds, until less and less is enough
_AWAY = 4.0  # times the last one wanted: what is still on its way there is no matter
_CREEPING = 1e-4, 1e2  # where they are sought, spacings of frequencies from 0
_CREEPERS = 24
_FADING = 0.01  # of what arrives, returned where a rod ends
_NONE = np.zeros(0, complex)
_I = acb(0, 1)


def remove_dashpots(network: Network) -> Network:
    """The same chain without its dashpots."""
    points = tuple(replace(point, damping=point.damping * 0) for point in network.points)
    return replace(
        network, points=points, links=tuple(replace(link, damping=link.damping * 0) for link in network.links)
    )


def proof_bits(network: Network) -> int:
    """Those that modes are proved with at most."""
    return _BITS + _BITS_A_ROW[-1][0] * len(Stiffness(network).points)


def search_modes(stiffness: Stiffness, count: int, again: int = 0, known: Complex = _NONE) -> FoundModes:
    """About the first `count` modes of a network as it is cut, with real parts of their frequencies of at least 0.

    Of a mode that creeps the real part is exactly 0. Shapes have mass 1 as `Trial` counts it.

    Args:
        stiffness: that of the network, without equal branches.
        count: how many.
        again: how often they were sought before.
        known: where some are.
    """
    guesses = estimate_frequencies(stiffness, count, again) if stiffness.points else np.zeros(1, complex)
    new = [w for w in known.tolist() if not np.any(np.abs(guesses - w) < _MEETING * abs(w))]
    guesses = np.concatenate([guesses, new])
    resting = _undamped_at_rest(stiffness, float(np.abs(guesses).max(initial=0.0)) * (1 + _MEETING))
    guesses = _leave_out(guesses, resting)
    found = _prove_modes(stiffness, guesses) if stiffness.points else [None]
    unproved = [k for k, mode in enumerate(found) if mode is None]
    several = [
        float(abs(guesses[k]))
        for k in unproved
        if np.count_nonzero(np.abs(guesses - guesses[k]) < _MEETING * abs(guesses[k])) > 1
    ]
    made = distinct_modes([*resting, *(mode for mode in found if mode)])
    return FoundModes(made, 0.0, min(several, default=None), is_open=bool(unproved))


def _undamped_at_rest(stiffness: Stiffness, limit: float) -> list[Mode]:
    """The modes of which all points but free ends rest, whatever dashpots there are."""
    with ctx.workprec(_BITS):
        return [mode.to_complex() for mode in resting_modes(stiffness, limit, free_ends=True)]


def _leave_out(guesses: Complex, modes: Sequence[Mode]) -> Complex:
    """Guesses without one for each of some modes, the nearest."""
    for mode in modes:
        off = np.abs(guesses - complex(mode.frequency))
        if len(off) and off.min() < _MEETING * abs(complex(mode.frequency)):
            guesses = np.delete(guesses, np.argmin(off))
    return guesses


def _prove_modes(stiffness: Stiffness, guesses: Complex) -> list[Mode | None]:
    near, rows = guesses * (1 + _OFF), len(stiffness.points)
    roots = stiffness.softest_rows(near, 1j * near).tolist()
    found: list[Mode | None] = [None] * len(guesses)
    for bits, sharp in _BITS_A_ROW if rows > _MANY_ROWS else _BITS_A_ROW[-1:]:
        with ctx.workprec(_BITS + bits * rows):
            law, small = stiffness.law(arb), arb(2) ** -(_BALL + sharp * rows)
            for k, (guess, root) in enumerate(zip(guesses.tolist(), roots, strict=True)):
                found[k] = found[k] or _prove_mode(stiffness, law, guess, root, small)
    return found


def estimate_frequencies(stiffness: Stiffness, count: int, again: int = 0) -> Complex:
    """The first frequencies in doubles, those with a real part of at least 0; from more places `again` and again."""
    stiffness = Stiffness(absorb(stiffness.network))
    if not stiffness.network.bars:
        return _eigenvalues(stiffness)[:count]
    many = (int(_MORE * count) + min(len(stiffness.network.bars), _BARS) + 4) << again
    start = bisect_frequencies(Stiffness(remove_dashpots(stiffness.network)), many)
    draw = np.random.default_rng(again)  # nothing is to stay symmetric by chance
    apart = np.pi / float(stiffness.delay)
    start = start + apart * (0.1j + 0.02 * (draw.normal(size=many) + 1j * draw.uniform(size=many)))
    creeping = apart * (np.geomspace(*_CREEPING, _CREEPERS << again) * 1j + 1e-3)
    fading = _estimate_fading(stiffness.network, many)
    w = np.concatenate([start, -start.conjugate() + 1e-3 * apart, creeping, fading, -fading.conjugate()])
    moving, resting = np.arange(len(w)), _RESTING * np.pi / float(stiffness.delay)
    for turn in range(_ROUNDS):
        apart = w[moving, None] - w
        apart[np.arange(len(moving)), moving] = np.inf
        with np.errstate(all="ignore"):
            step = 1 / (_slope_of_logarithm(stiffness, w[moving]) - (1 / apart).sum(axis=1))
        step = np.where(np.isfinite(step), step, 0.1 * draw.normal(size=len(step)))
        size = np.abs(step)
        step *= np.minimum(1.0, 2.0 / float(stiffness.delay) / np.maximum(size, 1e-300))
        w[moving] -= step
        enough = min(_FOUND * 2.0 ** max(0, turn - _PATIENT), _ROUGH)
        moving = moving[size > enough * np.abs(w[moving])]
        found = np.delete(w, moving)
        found = found[(found.real > -1e-9 * np.abs(found)) & (np.abs(found) > resting)]
        found = found[np.argsort(np.abs(found), kind="stable")][:count]
        away = np.abs(w[moving])
        if 0 < len(found) == count and np.all((away < resting) | (away > _AWAY * np.abs(found[-1]))):
            break
    return np.asarray(found)


def _estimate_fading(network: Network, many: int) -> Complex:
    """Where waves would swing in a rod that ends in nearly as large a dashpot as its impedance: so far from the others
    that no search comes there from them.

    Of what arrives the part r returns, so that after the delay T there and back again it is the same where
    exp(2 i w T) = 1/r, or -1/r.
    """
    found = [np.zeros(0, complex)]
    for end in bare_ends(network):
        returned = abs(nearest((end.impedance - end.damping) / (end.impedance + end.damping)))
        if 0 < returned < _FADING:
            turns = np.pi / 2 * np.arange(2 * many) - 0.5j * np.log(returned)
            found.append(turns / nearest(network.bars[end.bar].delay))
    return np.concatenate(found)


def _eigenvalues(stiffness: Stiffness) -> Complex:
    """All of them without bars: eigenvalues of x' = A x, x the places of all points and the velocities of masses."""
    law, size = stiffness.doubles, len(stiffness.points)
    k, c = np.diag(law.stiffness), np.diag(law.damping)
    for row, parent in enumerate(stiffness.parents):
        if parent is not None:
            k[row, parent] = k[parent, row] = law.coupling_stiffness[row]
            c[row, parent] = c[parent, row] = law.coupling_damping[row]
    mass = np.array(law.mass)
    heavy, light = np.flatnonzero(mass > 0), np.flatnonzero(mass == 0)
    # how fast points are: masses as they are, the others as dashpots let them
    speed = np.zeros((size, size + len(heavy)))
    speed[heavy, size + np.arange(len(heavy))] = 1.0
    if len(light):
        pulls = np.hstack([-k[light], -c[np.ix_(light, heavy)]])
        speed[light] = np.linalg.solve(c[np.ix_(light, light)], pulls)
    force = -np.hstack([k, np.zeros((size, len(heavy)))]) - c @ speed
    matrix = np.vstack([speed, force[heavy] / mass[heavy, None]])
    w = -1j * np.linalg.eigvals(matrix).astype(complex)
    w = w[(w.real > -_STRAIGHT * np.abs(w)) & (np.abs(w) > _RESTING * np.abs(w).max(initial=0.0))]
    return np.asarray(w[np.argsort(np.abs(w), kind="stable")])


def _slope_of_logarithm(stiffness: Stiffness, w: Complex) -> Complex:
    """The slope of the logarithm of det K times the sines of the bars over w."""
    law = stiffness.doubles
    angles = [w * delay for delay in law.delays]
    with np.errstate(all="ignore"):
        csc = [1 / np.sin(angle) for angle in angles]
        cot = [np.cos(angle) * each for angle, each in zip(angles, csc, strict=True)]
        diagonal, up = law.matrix(w, cot, csc, 1j * w)
        pulled = [c - a * s * s for c, s, a in zip(cot, csc, angles, strict=True)]
        shared = [a * s * c - s for c, s, a in zip(cot, csc, angles, strict=True)]
        bent = replace(law, stiffness=[0.0] * len(law.stiffness), coupling_stiffness=[0.0] * len(law.stiffness))
        slopes = bent.assemble(2 * w, pulled, shared, 1j)
        total = sum(n * (t * c - 1 / w) for n, t, c in zip(law.counts, law.delays, cot, strict=True))
        for row, parent in enumerate(stiffness.parents):
            pivot, slope = diagonal[row], slopes[0][row]
            total = total + slope / pivot
            if parent is not None:
                over = up[row] / pivot
                diagonal[parent] = diagonal[parent] - up[row] * over
                slopes[0][parent] = slopes[0][parent] - over * (2 * slopes[1][row] - over * slope)
    return np.asarray(total)


def _prove_mode(stiffness: Stiffness, law: HarmonicLaw, guess: complex, root: int, small: arb) -> Mode | None:
    """The mode near a guess, in which row `root` moves much, to `small` of it; None where that cannot be proved."""
    creeps = abs(guess.real) < _STRAIGHT * abs(guess)
    w = acb(0.0 if creeps else guess.real, guess.imag)
    for _ in range(_NEWTON):
        tried = trial(stiffness, law, w, root, _I * w)
        better = (w + tried.rest * tried.rows[root] / (2 * w * tried.mass)).mid()
        if not better.is_finite():
            return None
        if creeps:
            better = acb(0, better.imag)
        off, w = abs(better - w), better
        if off < abs(w) * small:
            break
    else:
        return None
    radius = (abs(w) * small).upper()
    ball = acb(arb(w.real, radius), arb(w.imag, radius))
    here, around = (trial(stiffness, law, v, root, _I * v) for v in (w, ball))
    slope = -2 * ball * around.mass / around.rows[root] ** 2
    inside = w - here.rest / here.rows[root] / slope
    if not ball.contains_interior(inside) or abs(complex(w) - guess) > _MEETING * abs(guess):
        return None
    if creeps:  # and so does the mirror image of the zero, which is the only one in the ball
        inside = acb(0, inside.imag)
    return complex_mode(stiffness, law, inside, root, SHARP)


def distinct_modes(modes: Sequence[Mode]) -> list[Mode]:
    """Each mode once, in their order; of those whose points rest several may have one frequency."""
    sizes = np.array([abs(complex(mode.frequency)) for mode in modes])
    kept: list[int] = []
    for k in np.argsort(sizes, kind="stable").tolist():
        beside = [j for j in kept[-_FEW:] if sizes[j] > sizes[k] * (1 - _BESIDE)]
        if not any(_is_same(modes[k], modes[j]) for j in beside):
            kept.append(k)
    return [modes[k] for k in kept]


def _is_same(one: Mode, other: Mode) -> bool:
    pairs = [(a, other.amplitudes.get(bar)) for bar, a in one.amplitudes.items()]
    apart = other.amplitudes and any(b is None or not a.overlaps(b) for a, b in pairs)
    opposite = [-q for q in other.points]
    moved = any(all(p.overlaps(q) for p, q in zip(one.points, each, strict=True)) for each in (other.points, opposite))
    return not apart and moved and bool(one.frequency.overlaps(other.frequency))
