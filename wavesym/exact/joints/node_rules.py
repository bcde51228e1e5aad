"""The laws of joints in exact numbers, each derived when it is first asked for: SymPy is needed only there."""

from __future__ import annotations

from flint import fmpq

from wavesym.derivation.exact_rule import JointRule, Weights


def joint_rule() -> JointRule:
    """What rods and points bring to a joint."""
    from wavesym.derivation.recurrence import joint_rule

    return joint_rule()


def factor_weights(rate: fmpq) -> Weights:
    """What D + `rate` does to the coefficients of exponentials times powers."""
    from wavesym.derivation.recurrence import factor_weights

    return factor_weights(rate)
