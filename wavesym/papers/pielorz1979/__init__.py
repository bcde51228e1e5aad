"""What Amalia Piełorz's paper of 1979 prints, as data, and the four tests that say what it means.

data/          passages of the text, cut into records by marks. transcript.py reads them
chains.py      the chains that all is tried on: exact tables, motion under loads, scenes that show it
letters.py     the one scope: what letters mean on a chain that moves, with and without dimensions
equations.py   the test of equations: (2.1)-(2.5), (3.1), (3.2), (4.1)-(4.8), (4.11), constants, Table 1; groups of them
               in equation_kinds.py, by equation_group.py
tables.py      the test of tables: Tables 2 to 4, (4.9), (4.10), (4.12), with forms.py and powers.py
coefficients.py  III.1 ... III.22, by the same exact tables
statements.py  the test of sentences: the examples; sentences.toml has the patterns
solutions.py, solution_powers.py  what the text says of the solutions, and of their highest powers
figures.py     the test of figures: section 5, with figure_scenes.py, measures.py and figure_loads.toml
paper.py       the test of every kind of record; all verdicts
"""
