"""Program -> files: C, NumPy and the manifest."""
