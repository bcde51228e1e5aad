"""What is proved of generated C, what a checker says of it, and where it was compiled and run: docs/portability.md."""
