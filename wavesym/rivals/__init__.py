"""What wavesym is measured against: other methods for (2.1)-(2.4), each in one short file, none from the derivation."""
