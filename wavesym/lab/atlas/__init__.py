"""The atlas of where methods fail: families of curves, and what they share."""
