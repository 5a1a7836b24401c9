"""What a reader may explore: one slider for frame, plots and scene, drawn by the page itself."""
