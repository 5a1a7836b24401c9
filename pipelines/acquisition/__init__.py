"""First pose of a known target: no prior, no names on the corners."""
