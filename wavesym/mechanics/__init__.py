"""Scene -> Chain: rods and nodes; one short file per system of the paper says which nodes it has."""
