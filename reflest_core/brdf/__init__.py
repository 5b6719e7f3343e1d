"""The Ward BRDF, its perceptual twin Lab/c,d, and the losses on both."""
