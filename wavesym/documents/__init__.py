"""What was derived, computed and compiled as text, LaTeX, JSON and CSV."""
