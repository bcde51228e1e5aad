"""The check of proved extremes, which `summary` shows, against values, those at the end of the horizon among them."""

from __future__ import annotations

from math import inf, nextafter

from wavesym.errors import WavesymError
from wavesym.exact.extremes import extremes
from wavesym.exact.reference import Reference
from wavesym.numbers.doubles import rational
from wavesym.verification.outcome import Outcome
from wavesym.verification.reference import Known
from wavesym.verification.refinement import shown

# extremes are right to 2^-52; values are rounded once, and so is each difference
_ROUNDED = 2.0**-51


def peaks(known: Known) -> list[Outcome]:
    """How far values lie beyond proved extremes, and how far each extreme is from the value at its instant.

    The instant is given as a double, which lies beside it: the change of values between two doubles is allowed.
    """
    try:
        found = extremes(known.model)
        near = {each.tau: _doubles(each.tau) for pair in found for each in pair}
        taus = sorted({tau for some in near.values() for tau in some})
        further = known.model.shortened(rational(max(known.until, taus[-1])))  # and just behind the horizon
        rows = Reference(further).values(taus)
    except WavesymError as refusal:
        note = f"{known.model.name}: no proved extremes to compare ({refusal})"
        return [Outcome(output.probe.name, {"beyond": "refused"}, True, note) for output in known.outputs]
    outcomes = []
    for output, pair, row in zip(known.outputs, found, rows, strict=True):
        at = dict(zip(taus, row, strict=True))
        least, greatest = (each.value for each in pair)
        scale = max(abs(least), abs(greatest)) or output.scale
        beyond = max(0.0, least - output.values.min(), output.values.max() - greatest) / scale
        off = change = 0.0
        for each in pair:
            if each.reached:  # there may be a jump: values change between two doubles on either side of it
                earlier, before, here, after = (at[tau] for tau in near[each.tau])
                off = max(off, abs(each.value - here) / scale)
                change = max(change, (abs(before - earlier) + abs(after - here)) / scale)
        cells = {"beyond": shown(beyond), "at": shown(off), "allowed": shown(_ROUNDED + change)}
        outcomes.append(Outcome(output.probe.name, cells, beyond <= _ROUNDED and off <= _ROUNDED + change))
    return outcomes


def _doubles(tau: float) -> tuple[float, float, float, float]:
    """Two before an instant of the horizon, it, and the one after it."""
    before = nextafter(tau, 0.0)
    return nextafter(before, 0.0), before, tau, nextafter(tau, inf)
