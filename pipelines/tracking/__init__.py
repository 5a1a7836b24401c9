"""From one frame to the next."""
