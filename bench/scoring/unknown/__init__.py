"""Images of a target that nobody has a model of, judged: its motion, its shape, its tracks."""
