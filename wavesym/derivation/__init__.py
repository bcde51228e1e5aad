"""System -> Recurrence: wave ansatz, delay equations, coefficient recurrences; SymPy, and only here."""
