"""The march, the evaluator for long horizons: its plan, its operators, one run of it, and what a run proves."""
