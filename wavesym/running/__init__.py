"""Generated text made to run: a compiler found, C built and loaded."""
