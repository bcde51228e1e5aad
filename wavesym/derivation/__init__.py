"""System -> Recurrence: wave ansatz, boundary conditions, delay equations, coefficient recurrences; SymPy, and only here."""
