"""A network as its own modes of vibration, undamped or complex, each stepped exactly."""
