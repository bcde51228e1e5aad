"""The modes of a scene that has damping, each with its ratio."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from wavesym.documents.inspection.section import Facts, Listing, Plain, Section, Told
from wavesym.errors import CostError, UnservedError
from wavesym.exact.modes.frequencies import frequencies
from wavesym.mechanics.model import Model
from wavesym.programs.modes.undamped import damping_ratios

_SHOWN = 12  # and those that damping is said of
_RIGID = 1  # modes without strain at most


def damped_modes(model: Model) -> Iterator[Section]:
    """The first modes with strain, and the rule for all; nothing where no damping is given."""
    damping = model.damping
    if damping is None:
        return
    count = max(_SHOWN, len(damping.ratios), *(damping.modes or (0,)))
    try:
        found = np.array([float(w) for w in frequencies(model.network, count + _RIGID)])
    except (CostError, UnservedError) as refusal:
        yield Facts("modes", "Modes are not known", {"refusal": str(refusal)})
        return
    w = found[found > 0][:count]
    rule = damping_ratios(damping, w.tolist())
    after = f"all higher ones have {rule.ratios[-1]:g}"
    if rule.rayleigh:
        after = "at any frequency w it is ({:.6g}/w + {:.6g} w)/2".format(*rule.rayleigh)
    rows: list[dict[str, Plain | Told]] = []
    for number, (frequency, ratio) in enumerate(zip(w.tolist(), rule.at(w).tolist(), strict=True), 1):
        period = 2 * np.pi / frequency
        row: dict[str, Plain | Told] = {"mode": number, "frequency": frequency, "period": period, "damping": ratio}
        if model.clock:
            row["seconds"] = period * float(model.clock.seconds)
        rows.append(row)
    yield Listing("modes", f"Modes: angular frequency and period in tau, and the damping ratio; {after}", rows)
