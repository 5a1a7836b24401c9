"""Image pairs of retroreflectors, judged."""
