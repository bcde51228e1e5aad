"""What tables of a scene are made of: exact numbers, keys that are checked, loads in time."""
