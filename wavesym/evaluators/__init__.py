"""Chain or Table -> Evaluator: what computes the outputs of a scene, and with which error."""
