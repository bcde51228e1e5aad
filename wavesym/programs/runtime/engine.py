"""What computes a program whose parameters come at run time, for many sets of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class FoundSets(NamedTuple):
    """Of each set its status (0; 1 a bad number; 2 bodies too light), its error estimate, or one of values and of each
    derivative, and what was asked for, all NaN where the status is not 0.
    """

    status: NDArray[np.int32]
    estimate: Array
    values: Array


def no_sets(sets: int, shape: tuple[int, ...], estimates: tuple[int, ...] = ()) -> FoundSets:
    """Room for what is found."""
    return FoundSets(np.empty(sets, np.int32), np.empty((sets, *estimates)), np.empty((sets, *shape)))


class Engine(Protocol):
    """`given` has a row for each set, with all fields side by side; `tau` is one-dimensional."""

    def values(self, given: Array, tau: Array) -> FoundSets:
        """Of shape (sets, 1, outputs, times)."""

    def tangents(self, given: Array, tau: Array) -> FoundSets:
        """The values, then their derivatives by each parameter: of shape (sets, 1 + parameters, outputs, times); and as
        many estimates, of shape (sets, 1 + parameters).
        """

    def misfit(self, tau: Array, data: Array) -> Callable[[Array], FoundSets]:
        """What makes of `given` the sums of the squares of all misfits, of shape (sets,). `data` of shape
        (outputs, times) is NaN where there is none.
        """

    def bounds(self, given: Array) -> FoundSets:
        """The proved bound of each output, of shape (sets, outputs). UnservedError where this cannot be computed."""

    def peaks(self, given: Array) -> FoundSets:
        """Of shape (sets, outputs, 4): the least value, its tau, the greatest value, its tau."""
