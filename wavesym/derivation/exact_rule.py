"""The law of a joint in exact numbers, for engines: SymPy is imported where it is first asked for, and only then."""

from __future__ import annotations

from flint import fmpq

from wavesym.derivation.rules import JointRule, Weights


def joint_rule() -> JointRule:
    """What rods and points bring to a joint; derived when it is first asked for: SymPy is needed only there."""
    from wavesym.derivation.recurrence import joint_rule

    return joint_rule()


def factor_weights(rate: fmpq) -> Weights:
    """What D + `rate` does to the coefficients of exponentials times powers; derived as `joint_rule` is."""
    from wavesym.derivation.recurrence import factor_weights

    return factor_weights(rate)
