"""Camera model, and the file that holds a camera's parameters."""
