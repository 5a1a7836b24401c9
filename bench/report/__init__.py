"""One HTML file that says what was run and how wrong it was."""
