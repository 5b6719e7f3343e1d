"""Pictures of a BRDF: a sphere under an environment or a point light. Not on the live path."""
