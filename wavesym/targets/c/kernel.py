"""The part of generated C that no scene changes: plain C in templates/c, with the name of a scene put in.

A compiler reads each of its files as it stands. Of a file generated C has the text below its first empty line; above
that it includes the files whose texts stand above its own: their order is stated there, and here followed. In texts
`name` and `NAME` stand for the scene's name, `name_real` for its type of numbers.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from posixpath import dirname, join, normpath

from wavesym.rendering import text_of
from wavesym.targets.description import Description

_WRITTEN = ("tables.h", "laws.h")
"""These stand for what templates write for each scene."""
_INCLUDED = re.compile(r'^#include "(.*)"', re.MULTILINE)
_ALONE = re.compile(r"^#if.*?^#endif", re.MULTILINE | re.DOTALL)
"""What only those need who read a file by itself."""


def kernel(file: str, scene: Description) -> str:
    """The text of templates/c/`file`, without what it includes."""
    return with_names(_parts(file)[1], scene)


def kernels(scene: Description, *files: str, above: Collection[str] = ()) -> str:
    """The texts of some of them, below those that they include, each once, but for what there is already `above`."""
    texts = dict.fromkeys(found for file in files for found in _list_texts(file, above))
    return "\n\n".join(kernel(file, scene) for file in texts)


def _list_texts(file: str, above: Collection[str]) -> Iterator[str]:
    for name in _INCLUDED.findall(_ALONE.sub("", _parts(file)[0])):
        included = normpath(join(dirname(file), name))
        if name not in _WRITTEN and included not in above:
            yield from _list_texts(included, above)
    yield file


def _parts(file: str) -> tuple[str, str]:
    """What is above the first empty line, and what is below."""
    head, _, text = text_of(f"c/{file}").partition("\n\n")
    return head, text.rstrip()


def with_names(text: str, scene: Description) -> str:
    """Plain C with the name of a scene, and its type of numbers."""
    text = re.sub(r"\bname_real\b", scene.real, text)
    return re.sub(r"\bname_", f"{scene.name}_", re.sub(r"\bNAME_", f"{scene.prefix}_", text))
