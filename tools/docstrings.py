"""What mkdocstrings is to make of docstrings: examples at a prompt are blocks of code, not quotations."""

from __future__ import annotations

import re
from typing import Any

from griffe import Extension, Object

EXAMPLE = re.compile(r"(?:^>>> .*\n?)(?:^(?!\s*$).*\n?)*", re.MULTILINE)


def fence_examples(text: str) -> str:
    """A docstring whose paragraphs that begin with `>>>` stand between fences."""
    return EXAMPLE.sub(lambda found: f"```pycon\n{found[0].rstrip()}\n```\n", text)


class Examples(Extension):  # type: ignore[misc]  # griffe comes with the extra docs
    """Mark the examples of every docstring that is shown."""

    def on_object(self, *, obj: Object, **_: Any) -> None:
        """Rewrite the docstring of one object before it is parsed."""
        if obj.docstring:
            obj.docstring.value = fence_examples(obj.docstring.value)
