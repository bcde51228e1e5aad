"""How a scene vibrates: its modes, and its answers to harmonic loads."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import TYPE_CHECKING, overload

from wavesym.scene import Scene, lower

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from wavesym.results.frequency_response import FrequencyResponse
    from wavesym.results.mode_ranges import ModeRanges
    from wavesym.results.modes import Modes
    from wavesym.results.response_ranges import ResponseRanges


@overload
def modes(
    scene: Scene | str | PathLike[str], count: int = 10, below: float | None = None, *, points: int | None = None
) -> Modes: ...


@overload
def modes(
    scene: Scene | str | PathLike[str],
    count: int = 10,
    below: float | None = None,
    *,
    ranges: Mapping[str, tuple[str, str]],
) -> ModeRanges: ...


def modes(
    scene: Scene | str | PathLike[str],
    count: int = 10,
    below: float | None = None,
    *,
    ranges: Mapping[str, tuple[str, str]] | None = None,
    points: int | None = None,
) -> Modes | ModeRanges:
    """The modes of vibration of a scene: frequencies, none missed, damping, effective masses and shapes.

    Args:
        scene: a Scene, a file, or the name of a built-in scene; it needs neither loads nor outputs.
        count: how many, where `below` is None; rigid modes come first, then shifts that only dashpots resist (both 0).
        below: all up to this frequency: in Hz, or in rad per tau for a scene without units.
        ranges: of paths, as of `scene.with_`, the least and the greatest value: for the range of each frequency over
            the box, in place of modes; `below` does not matter then.
        points: at how many points of each rod shapes are wanted, from 2 on: `along` has them, line by line.

    Returns:
        A sequence of modes with `number`, `omega`, `hz`, `period`, `damping`, `radius` (proved), `effective_mass`,
        `shape` and `loads` (of each load its participation); `complete` says whether none is missed, `why` in words.

    Raises:
        UnservedError: for contacts, and frequencies whose modes cannot be told apart.
        WavesymError: for a count, or a frequency, that is not positive.

    >>> import wavesym
    >>> wavesym.modes("drive_m1", 3)
    Modes('drive_m1', 3 modes: 0, 0.18084, 0.565872 1/tau)
    """
    from wavesym.results.mode_ranges import mode_ranges
    from wavesym.results.modes import modes as modes_of

    chain = scene if isinstance(scene, Scene) else Scene.from_toml(scene)
    if ranges is not None:
        return mode_ranges(chain, count, ranges)
    return modes_of(lower(chain, in_time=False), count, below, chain.system.lines, points)


@overload
def frf(
    scene: Scene,
    frequencies: ArrayLike | None = None,
    load: str | int | None = None,
    *,
    low: float | None = None,
    high: float | None = None,
    points: int = 400,
) -> FrequencyResponse: ...


@overload
def frf(
    scene: Scene,
    frequencies: ArrayLike | None = None,
    load: str | int | None = None,
    *,
    low: float | None = None,
    high: float | None = None,
    points: int = 400,
    ranges: Mapping[str, tuple[str, str]],
) -> ResponseRanges: ...


def frf(
    scene: Scene,
    frequencies: ArrayLike | None = None,
    load: str | int | None = None,
    *,
    low: float | None = None,
    high: float | None = None,
    points: int = 400,
    ranges: Mapping[str, tuple[str, str]] | None = None,
) -> FrequencyResponse | ResponseRanges:
    """The frequency response of a scene: complex amplitudes of its outputs under one unit of a load exp(+i w t).

    They come from the dynamic stiffness K(w) of the chain, in balls: dashpots, absorbing ends and modal damping too.

    Args:
        scene: a chain whose contacts do not open.
        frequencies: (n,), in Hz, or w in rad per tau for a scene without units, each the shortest decimal that reads
            back to it; None for `points` of them, equally spaced from `low` to `high`.
        load: its number in the scene from 0 on, or the node it acts on; None where there is one load.
        low: the first frequency, read like these; None for one step above 0, where chains that nothing holds have no
            answer.
        high: the last one, read like these; None for that of the fifth mode without dashpots.
        points: how many.
        ranges: of paths to masses, springs and dashpots, as of `scene.with_`, the least and the greatest value: for
            the range of each amplitude over the box, `low` and `high` (outputs, n), enclosed, in place of responses.

    Returns:
        `frequency`, `response[NAME]`, `amplitude`, `phase`, `values` (outputs, n), `bound`, `poles`; `peaks()` encloses
        the greatest amplitudes between the first and the last frequency, `to_pandas()`, `csv()` and `json()` make
        tables.

    Raises:
        WavesymError: for a load or a frequency that is none.
        UnservedError: for contacts that open, and modes that cannot be told apart.
        ToleranceError: where damping ratios would need too many modes for the scene's tolerance.
        CostError: for too many frequencies, and where a range has no enclosure.

    >>> import wavesym
    >>> response = wavesym.frf(wavesym.Scene.from_toml("building_m2"), [0.5, 1.0])
    >>> response
    FrequencyResponse('building_m2', 6 outputs at 2 frequencies from 0.5 to 1 rad per tau, bound 2.2e-16)
    >>> abs(response["strain@0.5"])
    array([4.60118888, 3.58758905])
    """
    from wavesym.results.frequency_response import equally_spaced, frequency_response
    from wavesym.results.transfer import harmonic_load
    from wavesym.scene.lowering import sources

    lowered = lower(scene, in_time=False)
    scene.refuse_without_output()
    acting = harmonic_load(lowered, sources(scene), load)
    at = equally_spaced(lowered, low, high, points) if frequencies is None else frequencies
    if ranges is not None:
        import numpy as np

        from wavesym.results.response_ranges import response_ranges

        return response_ranges(scene, acting, ranges, np.asarray(at, np.float64).ravel().tolist())
    return frequency_response(lowered, acting, at)
