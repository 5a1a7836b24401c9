"""``rvbench inspect``: what a mesh file holds, what is wrong with it, and a TOML to start from."""
