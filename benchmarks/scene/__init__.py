"""The scene that is measured on: an object on a table, filmed by a hand-held RGB-D camera."""
