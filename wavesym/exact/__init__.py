"""Laws run in exact and ball arithmetic: joints, tables, contacts, modes, and outputs as functions of tau from these."""
