"""Joints: their laws in numbers, their motion from knot to knot in balls or exactly, and the waves that they send."""
