"""Anything -> verdict: integrators that know nothing of the derivation, exact cross-checks, and compiled files run."""
