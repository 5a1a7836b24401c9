"""A spacecraft as edges and landmarks."""
