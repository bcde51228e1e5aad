"""Fields of a scene by the paths that messages name them with: `output.until`, `load[0].times[2]`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from wavesym.errors import SceneError, did_you_mean

_STEP = re.compile(r"(?:^|\.)([A-Za-z_]+)|\[([0-9]{1,6})\]")


def replace_at_path(fields: Mapping[str, Any], path: str, value: object) -> dict[str, Any]:
    """A copy of nested tables and lists with another value at a path. SceneError where the path leads nowhere."""
    result: dict[str, Any] = _replace(fields, steps(path), value, path)
    return result


def steps(path: str) -> list[str | int]:
    """The keys and indices that a path is made of. SceneError for what is no path."""
    found = list(_STEP.finditer(path))
    if not found or "".join(step[0] for step in found) != path:
        raise SceneError('not a path; write one such as "output.until" or "load[0].times[2]"', path)
    return [step[1] or int(step[2]) for step in found]


def leaves(fields: object, path: str = "") -> dict[str, object]:
    """The values of nested tables and lists that are neither, by path."""
    if isinstance(fields, Mapping):
        inner = [(f"{path}.{key}".lstrip("."), each) for key, each in fields.items()]
    elif isinstance(fields, list | tuple):
        inner = [(f"{path}[{k}]", each) for k, each in enumerate(fields)]
    else:
        return {path: fields}
    return {name: value for at, each in inner for name, value in leaves(each, at).items()}


def _replace(inner: Any, steps: list[str | int], value: object, path: str) -> Any:
    if not steps:
        return value
    step, *rest = steps
    if isinstance(step, int):
        if not isinstance(inner, list | tuple) or step >= len(inner):
            raise SceneError(f"nothing at [{step}]", path)
        return [_replace(each, rest, value, path) if k == step else each for k, each in enumerate(inner)]
    if step == "ground" and rest and isinstance(inner, Mapping) and inner.keys() & {"mass", "joint"}:
        return _replace(inner, rest, value, path)  # its keys are the part's own
    # what is new at the end of a path is judged with the whole scene
    if not isinstance(inner, Mapping) or (rest and step not in inner):
        known = inner if isinstance(inner, Mapping) else ()
        raise SceneError(f'nothing called "{step}". {did_you_mean(step, known)}'.rstrip(), path)
    return {**inner, step: _replace(inner.get(step), rest, value, path)}
