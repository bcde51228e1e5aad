"""Rational functions of a few symbols, as exact as numbers: what symbolic chains and tables are made of."""
