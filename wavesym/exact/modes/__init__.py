"""The modes of vibration of a chain, exact, each in balls: without dashpots all of them, none missed."""
