"""The derivation as people read it."""
