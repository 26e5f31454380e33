"""Camera model and the file of its parameters."""
