"""Records: what was measured, at even times, from the files that people have, every number as it is written."""
