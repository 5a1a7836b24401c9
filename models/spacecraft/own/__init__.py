"""A user's own spacecraft: a mesh file, and a TOML that says what the mesh does not."""
