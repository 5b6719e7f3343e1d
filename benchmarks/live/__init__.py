"""A bag at camera speed to the real node: own processes, real DDS, default settings."""
