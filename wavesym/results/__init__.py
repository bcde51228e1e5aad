"""What a user does with values."""
