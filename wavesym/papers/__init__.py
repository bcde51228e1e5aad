"""Papers judged: what one prints, formula by formula, with a verdict that is computed each time anew.

entries.py       passages of the source, and the records that are marked in them; selection.py, tables.py
reader.py        strings to trees (tree.py), by latex.lark; evaluation.py: trees to values in a scope
record.py        a test tried on what is printed, on what is right, and on faults (mutations.py): the verdict
sentences.py     the test of prose, by patterns
pages/           the verdicts as one list, in five formats; verdict_page.py puts it together
"""
