"""Papers judged: what one prints, formula by formula, with a verdict that is computed each time anew.

record.py        Claim -> Record: how a verdict comes about
exact_tables.py  the exact tables that formulas are tested on
report.py        text, JSON, Markdown
"""
