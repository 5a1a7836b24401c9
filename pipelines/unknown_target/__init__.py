"""A target that nobody has a model of: pose, rates, shape and inertia at once."""
