"""Evaluator -> files: dataclasses of strings for the templates, literals, rendering."""
