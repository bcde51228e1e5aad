"""Who wrote the paper, and how its tables are laid out: what pages say beside the verdicts."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from wavesym.papers.about import About, read_about


@cache
def about() -> About:
    """The particulars of data/paper.toml."""
    return read_about(Path(__file__).with_name("data") / "paper.toml")
