"""Start files of one's own: a case, a camera."""
