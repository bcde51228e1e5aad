"""What engines take: a network, the loads on it, its outputs, its numbers by name; every number exact."""
