"""Factors that the derivation gives, for engines that run on numbers: derived when they are first asked for.

SymPy is needed, and imported, only then.
"""

from __future__ import annotations

from flint import fmpq

from wavesym.derivation.rules import JointRule, Weights


def joint_rule() -> JointRule:
    """What rods and points bring to a joint, by (2.4)."""
    from wavesym.derivation.recurrence import joint_rule

    return joint_rule()


def factor_weights(rate: fmpq) -> Weights:
    """What D + `rate` does to the coefficients of exponentials times powers."""
    from wavesym.derivation.recurrence import factor_weights

    return factor_weights(rate)
