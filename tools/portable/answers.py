"""Answers of slow tools, kept in build/: a run that was stopped goes on where it was, and asks what has changed alone.

The question is all that the answer depends on: the text of the program, the command, the tool's version.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

from wavesym.writing import write_whole

FOLDER = Path("build", "portable")


def cached_answer(
    folder: Path, question: Sequence[str], answer: Callable[[], Any], *, worth: Callable[[Any], bool] = lambda _: True
) -> Any:
    """The answer (JSON) from `folder`, or given now and, where it is worth it, kept there."""
    file = folder / f"{sha256(json.dumps(list(question)).encode()).hexdigest()[:24]}.json"
    if file.is_file():
        return json.loads(file.read_text(encoding="utf-8"))
    given = answer()
    if worth(given):
        folder.mkdir(parents=True, exist_ok=True)
        write_whole({file: json.dumps(given)})
    return given
