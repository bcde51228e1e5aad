"""Many scenes that differ in a few fields or in their record: computed batch by batch, into one store.

request     what a user asks for: a file of TOML, or the same fields
dimension   the values of a field that is varied, and their coordinate
plan        the cases: which scene each of them is, and a hash of all that goes in
batches     the cases that are computed together: one chunk of every array
work        a batch computed, by `shared_records`, `parameters` or `single`
store       the arrays; marks, of what is done
engines     this process, local processes, or a cluster
running     batch by batch: computed, stored, marked
status      what is done and what has failed; table, a row for each case
"""
