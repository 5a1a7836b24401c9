"""What a star camera sees: stars, stray light, particles and what looks like a star."""
