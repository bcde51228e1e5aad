"""The outputs as lines of CSV, as they are computed: at even times, or at those that are asked for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from itertools import chain, islice
from time import monotonic

import numpy as np
from flint import fmpq

from wavesym.mechanics.model import Model
from wavesym.numbers.doubles import nearest, not_below
from wavesym.progress import tell_detail, warn_count
from wavesym.results.response import Response

SAMPLES = 1001  # where nobody says how many
_AT_ONCE = 5000  # tau


def csv_lines(response: Response, samples: int, at: Sequence[float] | None) -> Iterator[str]:
    """The header, then a line for each of `samples` even tau on the horizon, or for each of `at`.

    Of a physical scene `at` are times in the unit of results, and so is the first column. ToleranceError or CostError
    where no program will do; what goes wrong does so before there is a line.
    """
    count = samples if at is None else len(at)
    blocks = iter(partial(_rows, response, instants(response.model, samples, at)), [])
    if count > _AT_ONCE:
        response.prepare()  # what is done once says nothing of the rest
    start = monotonic()
    first = next(blocks, [])
    exact = "" if response.program else ", right to the last bit,"
    each = (monotonic() - start) / max(len(first), 1)
    helps = "fewer take less; so do programs of `generate`"
    warn_count(count, f"instants of {len(response.outputs)} outputs{exact}", each, helps)
    return _join(_columns(response.model), first, blocks, count)


def _join(names: Sequence[str], first: Sequence[str], blocks: Iterable[Sequence[str]], count: int) -> Iterator[str]:
    yield ",".join(names) + "\n"
    done = 0
    for block in chain([first], blocks):
        yield from block
        done += len(block)
        tell_detail(f"{done} of {count} instants")


def _columns(model: Model) -> list[str]:
    """The header, with units where there are any."""
    names = [probe.heading for probe in model.probes]
    clock = model.clock
    return ["tau" if clock is None else "time" if clock.unit == "s" else f"time [{clock.unit}]", *names]


def _rows(response: Response, instants: Iterator[tuple[float, float]]) -> list[str]:
    """The lines of the next instants, none where there are no more."""
    some = list(islice(instants, _AT_ONCE))
    values = np.vstack([np.asarray([first for first, _ in some]), response.values([tau for _, tau in some])]).T
    return [",".join(map(repr, row)) + "\n" for row in values.tolist()]


def instants(model: Model, samples: int, at: Sequence[float] | None) -> Iterator[tuple[float, float]]:
    """What stands in the first column, and the tau that it is."""
    clock, until = model.clock, model.until
    if clock is None:
        yield from ((tau, tau) for tau in (at if at is not None else grid(model, samples)))
    elif at is not None:
        yield from ((time, clock.tau(time, until)) for time in at)
    else:
        taus = (until * k / max(samples - 1, 1) for k in range(samples))
        yield from ((clock.time(tau), not_below(tau)) for tau in taus)


def grid(model: Model, samples: int) -> Iterator[float]:
    """`samples` equally spaced tau, each rounded once; the last one is the end of the horizon."""
    yield from (nearest(model.until * k / (samples - 1)) for k in range(samples - 1))
    yield model.horizon() if samples > 1 else 0.0


def own_samples(model: Model, comb: tuple[fmpq, fmpq] | None) -> list[float]:
    """Instants of tau on the horizon that are whole steps from the first of `comb`, or, without one, those of `run`."""
    if comb is None:
        return list(grid(model, SAMPLES))
    begin, step = comb
    count = int(((model.until - begin) / step).floor()) + 1
    return [nearest(begin + k * step) for k in range(-int((begin / step).floor()), count)]
