"""What the light seen in the background explains of the surface's colours."""
