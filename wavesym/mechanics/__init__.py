"""Scene -> Model: rods, nodes and loads, every number exact; a short file for each system of the paper."""
