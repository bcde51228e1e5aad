"""The fourth program: a chain as its own modes of vibration, each stepped exactly."""
