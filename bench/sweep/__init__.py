"""Many Suns, exposures and lamp powers on a pose: light traced once, every frame tried, one map."""
