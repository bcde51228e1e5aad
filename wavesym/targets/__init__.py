"""Program -> files: a folder for each language, whose `TARGET` is what target.py says, and the manifest.

Other rooms ask files.py.
"""

from wavesym.programs.request import TARGETS

__all__ = ["TARGETS"]
