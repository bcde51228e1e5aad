"""System II: m shafts between m + 1 rigid discs under step moments; (4.4)."""

from __future__ import annotations

from wavesym.model.node import Family, Load, Node, Parameters, Quantity, Rod, System, single


def _families(m: Quantity, p: Parameters) -> tuple[Family, ...]:
    def shaft(i: Quantity) -> Rod:
        return Rod(tau0=0, x0=i - 1)

    def moment(number: Quantity, sign: int = 1) -> tuple[Load, ...]:
        # the A_i of (4.4), in units of G J_01 theta_0 / l
        return (Load("M", number, (sign * p.kappa[1] * p.inertia[1] / p.inertia[number],)),)

    def pull(i: Quantity) -> Quantity:
        """What shaft i does to disc i + 1."""
        return 2 * p.kappa[i] * p.inertia[i] / p.inertia[i + 1]

    return (
        single(0, lambda: Node(None, shaft(1), inertia=1, alpha=0, beta=2 * p.kappa[1], loads=moment(1))),
        Family(
            1,
            m - 1,
            1,
            lambda i: Node(
                shaft(i), shaft(i + 1), inertia=1, alpha=pull(i), beta=2 * p.kappa[i + 1], loads=moment(i + 1)
            ),
        ),
        # the last moment counts against positive rotation, as in the paper
        single(m, lambda: Node(shaft(m), None, inertia=1, alpha=pull(m), beta=0, loads=moment(m + 1, sign=-1))),
    )


DRIVE = System("drive", _families, smallest=1)
