"""Program -> files: a folder for each language, and the manifest. Other rooms ask files.py."""

TARGETS = ("c", "numpy")
"""The languages. Each is the name of a folder here, whose `TARGET` is what target.py says; a new one is a name more."""

LANGUAGES = (*TARGETS, "all")
"""What `generate --language` takes."""

SIMULATORS = ("fmu2", "fmu3")
"""What `generate --target` takes: versions of FMI."""
