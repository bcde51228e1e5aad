"""What the paper prints, as data, with a verdict on every formula that is computed each time anew.

claims.py           all of them, in the order of the paper
signals.py          formulas about waves: read once, tested in numbers and in symbols
displacements.py    the exact motion at any place and time, and what acts on nodes
motion.py           (2.1), (2.2), (2.5), (4.1), (4.2); definitions.py has the quantities without dimensions
loads.py            (3.1), (3.2) and the loads of Table 1; clocks.py has the rest of it, but for c_f^2
constants.py        c_f^2, kappa and A in terms of materials
makeup.py           what the examples are made of, and where waves run
node_motion.py      what conditions are written in; conditions.py has (2.3), (2.4), (4.3)-(4.5)
delays.py           (4.6)-(4.8)
forms.py            (4.9)-(4.12)
powers.py           what Tables 2, 3 and 4 have in common; table_2_collision.py, table_3_drive.py, table_4_building.py
recurrence.py       what recurrences are written in; building_lines.py has III.1 ... III.22, building_list.py tests
                    them, building_alone.py runs them from nothing
prose.py            statements in the text, figures.py those about the figures
"""
