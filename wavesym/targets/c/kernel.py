"""The part of generated C that no scene changes: plain C in templates/c, with the name of a scene put in."""

from __future__ import annotations

import re

from wavesym.rendering import text_of
from wavesym.targets.description import Description


def kernel(file: str, scene: Description) -> str:
    """The text of templates/c/`file` below its first empty line; what is above is for those who read it by itself.

    There `name` and `NAME` stand for the scene's name, `name_real` for its type of numbers.
    """
    return with_names(text_of(f"c/{file}").partition("\n\n")[2].rstrip(), scene)


def with_names(text: str, scene: Description) -> str:
    """Plain C with the name of a scene, and its type of numbers."""
    text = re.sub(r"\bname_real\b", scene.real, text)
    return re.sub(r"\bname_", f"{scene.name}_", re.sub(r"\bNAME_", f"{scene.prefix}_", text))


def kernels(scene: Description, *files: str) -> str:
    """Some of them, one below the other."""
    return "\n\n".join(kernel(file, scene) for file in files)
