"""From frames to the observed surface: TSDF volume, voxel observation store, F and B."""
