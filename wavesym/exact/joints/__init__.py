"""Joints: their laws in numbers, their motion on stretches in balls or exactly, and the waves that they send."""
