"""What an output with one reading reads."""

from __future__ import annotations

from wavesym.mechanics.gauge import Gauge
from wavesym.mechanics.probe import Probe


def gauge(probe: Probe) -> Gauge:
    return Gauge(probe.quantity, probe.rod, probe.place, probe.point)
