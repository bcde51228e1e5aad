"""The march of parameters at run time in NumPy, all sets at once: what templates/c/runtime/runtime.c does for one set.

Arrays have the degrees of series first and the sets last; derivatives have their parameters, lanes, before nodes.
"""
