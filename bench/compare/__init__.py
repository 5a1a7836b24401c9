"""Methods compared on the same frames: paired, with intervals, by range, phase angle and tumble."""
