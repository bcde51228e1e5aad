"""Laws run in exact and ball arithmetic: joints, tables, contacts, modes; outputs as functions of tau from these."""
