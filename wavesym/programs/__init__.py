"""Model -> program: the closed form, pieces or a march, with proved bounds, and the choice between them."""
