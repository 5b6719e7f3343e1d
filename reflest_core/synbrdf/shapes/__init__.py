"""Shapes of SynBRDF's objects: procedural ones, and meshes from files."""
