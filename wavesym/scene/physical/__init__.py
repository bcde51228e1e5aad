"""Scenes in physical units, rewritten at the edge as the dimensionless scenes that all else knows."""
