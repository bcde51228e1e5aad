"""Libraries of extras, imported where they are used."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from wavesym.errors import WavesymError, install_command


def require_packages(library: str, extra: str) -> Any:
    """A library that an extra of wavesym brings. WavesymError, which names the extra, where it is not installed."""
    try:
        return import_module(library)
    except ImportError:
        raise WavesymError(f"{library} is not installed: {install_command(extra)}") from None
