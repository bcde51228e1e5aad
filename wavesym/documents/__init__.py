"""What was derived and computed as text, LaTeX, JSON and CSV."""
