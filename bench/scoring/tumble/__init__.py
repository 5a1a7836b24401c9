"""Single images of a free target, judged."""
