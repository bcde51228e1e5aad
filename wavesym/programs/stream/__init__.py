"""Loads that a controller gives sample by sample: a march on panels that begins each one with what is known then."""
