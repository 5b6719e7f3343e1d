"""Training the networks on SynBRDF and measuring what they reach. Not on the live path."""
