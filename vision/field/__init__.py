"""The field: its landmarks, and where the camera is among them."""
