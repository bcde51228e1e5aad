"""What A. Pielorz's paper of 1979 prints, as data, and the adapters that say what its letters mean.

data/            passages of the text, cut into records; hashes of the lines of the source
paper.py         every kind of record with its adapter; all verdicts. transcript.py reads the data
truth.py         what formulas are compared with; dependence.py, meetings.py tell more of the motion
letters.py       what letters mean on a chain that moves, in numbers; symbols.py in symbols, as in the derivation;
                 equations.py what all equations share
conditions.py    (2.3), (2.4), (4.3)-(4.5); delays.py (4.6)-(4.8)
motion.py        (2.1), (2.2), (2.5), (3.1), (3.2), (4.1), (4.2), the quantities without dimensions, loads in Table 1
constants.py     kappa, A, c_f; clocks.py the rest of Table 1
statements.py    what is said of the examples and their equations, with statements.toml
cells.py         Tables 2 to 4, with heads.py and rates.py; limits.py says which cell a letter of a form is
forms.py         (4.9), (4.10), (4.12), with form_constants.py
coefficients.py  III.1 ... III.22, with lines.py; alone.py runs them from nothing
prose.py         sentences of section 4, with sayings.toml; remarks.py the formulas within them
figures.py       section 5, with figure_scenes.py and measures.py, figure_sentences.toml and figure_loads.toml
"""
