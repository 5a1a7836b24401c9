"""A satellite in flight as its own navigation meets it: orbit, attitude, satellites, sensors."""
