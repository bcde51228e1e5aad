"""What measures and proves wavesym for its makers; users have no need of it."""
