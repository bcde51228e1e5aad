"""A scene as a stream, whose loads come while it runs: how large it is, and what a step of it costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wavesym.documents.inspection.section import Facts, Told
from wavesym.errors import WavesymError
from wavesym.mechanics.model import Model
from wavesym.programs.request import Request
from wavesym.programs.stream.making import stream_program
from wavesym.programs.stream.plan import inputs_of

_REQUEST = Request(stream=True)


def streamed(model: Model, sources: Sequence[str]) -> Facts:
    """The stream that `generate --stream` makes of a model whose loads have these sources, or why there is none."""
    endless = replace(model, endless=True)
    try:
        made = stream_program(endless, _REQUEST, inputs_of(endless, sources))
    except WavesymError as refusal:
        return Facts("stream", "As a stream, whose loads come while it runs, there is none", {"refusal": str(refusal)})
    numbers = made.constants
    waves, each = (
        made.real.bytes * int(numbers[count] * (numbers["degree"] + 1)) for count in ("slot_count", "entry_count")
    )
    direct = {
        output.name: [made.sources[j] for j in of] for output, of in zip(made.outputs, made.direct, strict=True) if of
    }
    return Facts(
        "stream",
        "As a stream (--stream), whose loads come while it runs; multiplications are counted with an addition each",
        {
            "inputs": list(made.sources),
            "direct": direct,
            "panel": numbers["panel"],
            "degree": numbers["degree"],
            "state_bytes": Told(waves, f"about {waves}"),
            "breakpoints": numbers["breakpoints"],
            "breakpoint_bytes": each,
            "bytes": made.bytes,
            "panel_work": numbers["operations"],
            "step_work": numbers["step_operations"],
        },
    )
