"""The pipeline of the colour camera at an arm's end."""
