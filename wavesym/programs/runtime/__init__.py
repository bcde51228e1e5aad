"""Parameters at run time: a march whose laws are rational functions of what its user gives, and which keeps no window
but polynomials of the outputs.
"""
