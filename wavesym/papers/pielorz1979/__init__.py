"""What A. Pielorz's paper of 1979 prints, as data, and the adapters that say what its letters mean.

data/            passages of the text, cut into records; hashes of the lines of the source
paper.py         every kind of record with its adapter; all verdicts. transcript.py reads the data
truth.py         what formulas are compared with; displacements.py, dependence.py, meetings.py tell more of the motion
conditions.py    (2.3), (2.4), (4.3)-(4.5); delays.py (4.6)-(4.8), systems.py what is said of them as systems;
                 letters.py and at_node.py say what their letters mean
motion.py        (2.1), (2.2), (2.5), (4.1), (4.2); definitions.py the quantities without dimensions; loads.py (3.1),
                 (3.2); constants.py kappa, A, c_f; clocks.py Table 1; makeup.py what sections 2 and 3 say of the parts
cells.py         Tables 2 to 4, with heads.py and rates.py; limits.py says which cell a letter of a form is
forms.py         (4.9), (4.10), (4.12), with form_constants.py
coefficients.py  III.1 ... III.22, with lines.py; alone.py runs them from nothing
prose.py         sentences of section 4, with sayings.toml; remarks.py the formulas within them
figures.py       section 5, with figure_scenes.py, figure_sentences.py and bodies.py
"""
