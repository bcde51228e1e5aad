"""Program -> files: for each language a module or a folder, which has `files` and `HAS_SELFTEST`, and the manifest.

Other rooms ask files.py.
"""

from wavesym.programs.request import TARGETS

__all__ = ["TARGETS"]
