"""The march: waves window by window, for long horizons and many rods, in constant memory and with a proved bound."""
