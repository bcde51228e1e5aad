"""Figures as files, with the same bytes from the same figure: no date, no random names."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from wavesym.errors import SceneError
from wavesym.writing import write_whole

FORMATS = {".svg": {"Date": None}, ".png": {"Software": None}, ".pdf": {"CreationDate": None}}


def picture_format(path: Path) -> str:
    """The suffix of a picture's file. SceneError for one that is no picture."""
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise SceneError(f"not a picture; write a name that ends in {', '.join(FORMATS)}", file=str(path))
    return suffix


def save(figure: Figure, path: Path) -> None:
    """Write a figure as .svg, .png or .pdf, whole or not at all. SceneError, OSError."""
    suffix = picture_format(path)
    content = BytesIO()
    with mpl.rc_context({"svg.hashsalt": "wavesym"}):
        figure.savefig(content, format=suffix[1:], metadata=FORMATS[suffix])
    write_whole({path: content.getvalue()})
