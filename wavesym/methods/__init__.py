"""Other methods for the same equations, which wavesym is compared with; none uses anything of the derivation."""
