"""A machine that has no C compiler."""

from contextlib import contextmanager

import pytest

from wavesym.running import toolchain


@contextmanager
def without_compiler():
    """As long as this is open."""
    with pytest.MonkeyPatch.context() as machine:
        machine.delenv("CC", raising=False)
        machine.setenv("PATH", "")
        machine.setattr(toolchain, "find_spec", lambda name: None)
        yield
