"""Exact rationals, rational functions, doubles and floats and their neighbours, Chebyshev polynomials."""
