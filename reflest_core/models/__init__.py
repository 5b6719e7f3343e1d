"""The networks of section 3.3, their weights and how they look at a surface."""
