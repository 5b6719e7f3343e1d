"""What the networks see of an observed surface."""
