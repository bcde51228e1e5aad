"""Measured: speed against accuracy, benchmarks, and the atlas of where methods fail."""
