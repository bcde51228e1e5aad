"""Recurrence -> Table: the recurrences run in exact arithmetic, one unit response per source."""
