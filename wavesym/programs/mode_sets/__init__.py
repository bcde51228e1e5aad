"""Modes in doubles of many sets of numbers at once: their errors are estimated, not proved."""
