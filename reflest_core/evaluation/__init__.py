"""What the networks reach: the paper's tables and figures, measured again. Not on the live path."""
