"""A motion that is known for any tau without stepping through time: two equal discs on a shaft, twisted for a while.

Opposite unit moments act on the discs from tau = 0 to 1/2. By symmetry the motion is a sum of the modes
sin(w (x - 1/2)) with w tan(w/2) = kappa, so w_k = 2 pi k + d_k with a small d_k, and a mode of modal mass N, pushed by
F = -2 sin(w/2), swings as F/(N w^2) (cos w(tau - 1/2) - cos w tau) from tau = 1/2 on.

Where tau is a multiple of 1/32 the phase 2 pi k tau is known exactly, and only d_k tau is rounded: by as much as
matters in the first modes, which are therefore summed in balls. The last modes are faded out; what is smooth, as
everything is away from fronts, does not miss them. Nothing here is shared with the march.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from flint import arb, ctx

from wavesym.numbers.arrays import Array
from wavesym.numbers.doubles import midpoint, rational
from wavesym.scene import Scene

LASTS = Fraction(1, 2)
STRAIN_AT = Fraction(1, 4)

_EXACT = 100
_MODES = 100_000
_FADED = 36.0  # the last mode keeps e^-36
_NEWTON = 40
_BITS = 192


def twisted(kappa: Fraction, until: int) -> Scene:
    """The drive, with the strain at 1/4 and the velocity of the first disc as outputs."""
    system = {"type": "drive", "m": 1, "kappa": [kappa], "inertia": [1, 1]}
    moments = [{"body": body, "times": [0, LASTS], "steps": [1, -1]} for body in (1, 2)]
    output = {"until": until, "tolerance": Fraction(1, 10**10), "strain": [STRAIN_AT], "velocity": [0]}
    return Scene.model_validate({"name": "twisted", "system": system, "load": moments, "output": output})


def calm(windows: Sequence[int]) -> Array:
    """Instants on these windows at which no front is nearer than 1/16 to either output."""
    return np.array([n + (2 * j + 1) / 16 for n in windows for j in range(8)])


def modal_sum(kappa: Fraction, taus: Array) -> Array:
    """Both outputs at multiples of 1/32 later than 1/2: shape (2, n)."""
    return _first(kappa, taus) + _others(float(kappa), taus)


def _first(kappa: Fraction, taus: Array) -> Array:
    """The modes below `_EXACT`, in balls."""
    result = np.empty((2, len(taus)))
    with ctx.workprec(_BITS):
        k = arb(rational(kappa))
        modes = [_mode(k, n) for n in range(_EXACT)]
        for j, tau in enumerate(map(rational, taus.tolist())):
            strain = velocity = arb(0)
            for w, bend, sway in modes:
                now, then = w * arb(tau), w * arb(tau - rational(LASTS))
                strain += bend * (then.cos() - now.cos())
                velocity += sway * (now.sin() - then.sin())
            result[:, j] = midpoint(strain), midpoint(velocity)
    return result


def _mode(kappa: arb, n: int) -> tuple[arb, arb, arb]:
    """The frequency, and what the mode gives to strain and velocity."""
    low = 2 * arb.pi() * n
    d = arb(float(_shifts(float(kappa), np.array([float(n)]))[0]))
    for _ in range(4):  # each doubles the digits
        w, tangent = low + d, (d / 2).tan()
        d = (d - (w * tangent - kappa) / (tangent + w / 2 * (1 + tangent * tangent))).mid()
    w = low + d
    half = (w / 2).sin()
    push = -2 * half / (arb(1) / 2 - w.sin() / (2 * w) + 2 / kappa * half * half)
    return w, push / w * (w * (arb(rational(STRAIN_AT)) - arb(1) / 2)).cos(), -push / w * half


def _others(kappa: float, taus: Array) -> Array:
    """The modes from `_EXACT` on, in doubles, the last of them faded out."""
    n = np.arange(_EXACT, _MODES, dtype=np.float64)
    d = _shifts(kappa, n)
    w = 2 * np.pi * n + d
    sign = np.where(n % 2 == 0, 1.0, -1.0)  # cos(pi n)
    half = sign * np.sin(d / 2)
    push = -2 * half / (0.5 - np.sin(d) / (2 * w) + 2 / kappa * half * half)
    push *= np.exp(-_FADED * (n / _MODES) ** 8)
    at = float(STRAIN_AT) - 0.5
    bend, sway = push / w * np.cos(2 * np.pi * (n * at % 1) + d * at), -push / w * half
    result = np.empty((2, len(taus)))
    for j, tau in enumerate(taus.tolist()):
        now = 2 * np.pi * (n * tau % 1) + d * tau
        before = tau - float(LASTS)
        then = 2 * np.pi * (n * before % 1) + d * before
        result[:, j] = bend @ (np.cos(then) - np.cos(now)), sway @ (np.sin(now) - np.sin(then))
    return result


def _shifts(kappa: float, n: Array) -> Array:
    """d > 0 with (2 pi n + d) tan(d/2) = kappa, by Newton's method from above, where the left side is convex."""
    low = 2 * np.pi * n
    d = np.minimum(2 * kappa / np.maximum(low, np.sqrt(2 * kappa)), 3.0)
    for _ in range(_NEWTON):
        tangent = np.tan(d / 2)
        d = d - ((low + d) * tangent - kappa) / (tangent + (low + d) / 2 * (1 + tangent * tangent))
    return d
