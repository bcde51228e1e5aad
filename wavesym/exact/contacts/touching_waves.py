"""The waves of a network with contacts: as `network_waves`, with what is closed on each stretch."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from operator import itemgetter

from flint import fmpq, fmpq_poly

from wavesym.exact.contacts.branches import Branches
from wavesym.exact.contacts.joint_stretch import JointStretch
from wavesym.exact.contacts.touching_joint import TouchingJoint
from wavesym.exact.joints.enclosure import Enclosure, add_terms
from wavesym.exact.joints.network_waves import SentWave, Waves, stretches_in_order
from wavesym.mechanics.loads import AppliedLoad
from wavesym.mechanics.network import End, Network


@dataclass(frozen=True)
class Stage:
    """The start of a stretch of a joint, and what its corners do on it."""

    start: fmpq
    branches: Branches


class TouchingWaves(Waves):
    """The waves of some joints, moved stretch by stretch from outside."""

    def __init__(self, network: Network, joints: Iterable[int], loads: Sequence[AppliedLoad]) -> None:
        super().__init__(network)
        self.joints = {number: TouchingJoint(network, number, loads) for number in joints}
        self._bare: dict[End, list[tuple[fmpq, bool]]] = {
            end: [] for number in self.joints for end, _ in network.joints[number].ends
        }

    def is_bare(self, end: End, tau: fmpq) -> bool:
        """Free, or beside a contact that is open from then on."""
        known = self._bare.get(end)
        return known[bisect_right(known, tau, key=itemgetter(0)) - 1][1] if known else super().is_bare(end, tau)

    def record(self, number: int, start: fmpq, moved: JointStretch) -> list[bool]:
        """Keep what a joint sends from an instant on; for each end, whether another function begins there.

        Where one goes on that is known exactly, nothing is kept.
        """
        joint = self.network.joints[number]
        for n, (end, _) in enumerate(joint.ends):
            known, bare = self._bare[end], n in moved.bare
            if not known or known[-1][1] != bare:
                known.append((start, bare))
        begun = [self._append(self.sent[end], start, moved.sends[n]) for n, (end, _) in enumerate(joint.ends)]
        for k, point in enumerate(joint.points):
            if point in self.velocities:
                self._append(self.velocities[point], start, add_terms(moved.velocities[k]))
        return begun

    def round_to_precision(self, ends: Mapping[int, fmpq]) -> TouchingWaves:
        """The same at the working precision, with no more powers than it needs; `ends` are those of the last stretches.

        How joints move is no longer told.
        """
        same, joint_of, point_at = copy(self), self.network.joint_of, self.network.point_at

        def anew(wave: SentWave, joint: int) -> SentWave:
            return wave.round_to_precision(ends[joint]) if joint in ends else wave

        same.sent = {end: anew(wave, joint_of[point_at(end)]) for end, wave in self.sent.items()}
        same.velocities = {point: anew(wave, joint_of[point]) for point, wave in self.velocities.items()}
        return same

    @staticmethod
    def _append(wave: SentWave, start: fmpq, new: Enclosure) -> bool:
        if wave.starts and wave.starts[-1] == start:
            wave.stretches[-1] = new
            return False
        if wave.starts:
            old = wave.stretches[-1].exact
            if old is not None and new.exact is not None and _goes_on(old, start - wave.starts[-1], new.exact):
                return False
        wave.starts.append(start)
        wave.stretches.append(new)
        return True


def _goes_on(old: fmpq_poly, by: fmpq, new: fmpq_poly) -> bool:
    if old.length() != new.length():
        return False
    return bool((old(fmpq_poly([by, 1])) if old.length() > 1 else old) == new)


def replay(
    network: Network,
    stages: Mapping[int, Sequence[Stage]],
    breakpoints: Mapping[int, Sequence[fmpq]],
    loads: Sequence[AppliedLoad],
) -> TouchingWaves:
    """The waves at the working precision, from the stages of all joints and the breakpoints between these."""
    waves = TouchingWaves(network, stages, loads)
    for start, number, place, end in stretches_in_order(breakpoints):
        joint, arriving = waves.joints[number], waves.arriving(number, start, end - start)
        moved = joint.move(arriving, start, end - start, stages[number][place].branches)
        waves.record(number, start, moved)
        joint.take(moved)
    return waves
