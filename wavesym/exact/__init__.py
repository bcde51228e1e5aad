"""Laws run in exact and ball arithmetic: tables, arrivals, waves on windows, reference values, contacts that end."""
