"""The march of any chain without contacts: rings of windows for the waves in every bar, joints as blocks."""
