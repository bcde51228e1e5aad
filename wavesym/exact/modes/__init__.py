"""The modes of vibration of an undamped chain, exact: all of them, none missed, each in balls."""
