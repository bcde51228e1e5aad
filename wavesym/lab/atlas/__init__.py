"""The atlas of where methods fail: each family of curves in a file of its own, what they share in the others."""
