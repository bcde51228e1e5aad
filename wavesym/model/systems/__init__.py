"""The systems of the paper, each in a file."""
