"""SynBRDF: physically-based synthetic scans with known materials. Not on the live path."""
