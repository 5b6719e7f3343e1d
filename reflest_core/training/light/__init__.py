"""Training ``lightnet``, the network that knows the light seen behind the object."""
