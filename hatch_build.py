"""The long description of the package: README, but for pictures and for links that lead nowhere outside the project."""

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

_PICTURE = re.compile(r"^!\[[^\]]*\]\([^)]*\)\n\n(\*[^\n]*\*\n\n)?", re.MULTILINE)  # with its caption
_LINK = re.compile(r"\[([^\]]*)\]\((?!https?:)[^)\s]*\)")


class PackagedReadme(MetadataHookInterface):
    """What an index shows of a package."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Write the description into the metadata."""
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {"content-type": "text/markdown", "text": _LINK.sub(r"\1", _PICTURE.sub("", text))}
