"""What flies: frames in, estimates out."""
