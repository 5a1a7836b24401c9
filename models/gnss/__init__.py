"""Navigation satellites, their signals, and a receiver's noise."""
