"""Camera models and the file of their parameters."""
