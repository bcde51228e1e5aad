"""Measured: how fast programs are, how exact for their time, where methods fail, and what is proved of generated C."""
