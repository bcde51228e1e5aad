"""The constants are judged by what chains with them do, and by their strings alone."""

from __future__ import annotations

import pytest
from flint import fmpq

from tests.papers.falsified import ENTRIES, judged
from wavesym.papers.pielorz1979.chains import loaded_chain
from wavesym.papers.pielorz1979.letters import Material, Units


@pytest.mark.parametrize(
    ("id", "changes"),
    [
        ("(4.3).kappa", {"slip": {"correction": r"\kappa_i = \frac{2F\rho l}{M_i}"}}),
        ("(4.3).kappa", {"slip": {"correction": r"\kappa_i = 0"}}),
        ("(4.3).kappa", {"ranges": (r"i = 1, 2, \dots, m-1",)}),
        ("(4.4).kappa", {"printed": r"\kappa_i = \frac{J_{0,1} \rho l}{J_i}"}),
        ("(4.4).kappa", {"inferred_ranges": (r"i = 1, 2, \dots, m+1",)}),
        ("(4.4).A", {"slip": {"ranges": (r"S_0 = \frac{G J_{0,1} U_0}{2l}",)}}),
        ("(4.5).kappa", {"slip": {"ranges": ENTRIES["(4.5).kappa"].ranges}}),
        ("def.s", {"slip": {"ranges": ()}}),
        ("T1.III.c_f^2", {"printed": r"\frac{G}{\rho} = C^2"}),
    ],
)
def test_a_wrong_string_is_a_verdict(id, changes):
    record = judged(id, **changes)
    assert record.verdict == "untested"
    assert record.problems


def test_the_bodies_and_rods_of_a_chain_have_the_laws_of_its_nodes():
    """The rate of a body is what its rods pull, over its inertia, in the units of the chain."""
    for name, m in (("I", 4), ("II", 3), ("III", 3)):
        chain = loaded_chain(name, m).exact.chain
        units = Units(fmpq(2), fmpq(3), fmpq(5, 7))
        material = Material(chain, units)
        for x, node in enumerate(chain.nodes):
            if node.inertia:
                pulls = sum(material.stiffness(rod) for rod in (x, x + 1) if 1 <= rod <= m)
                body = material.inertia(x + 1 if name == "II" else x)
                assert node.rate == pulls / body * units.l / units.c_f**2, (name, x)
