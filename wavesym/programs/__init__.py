"""Model -> Program: closed form, pieces, modes or a march, with proved bounds, and the choice between them."""
