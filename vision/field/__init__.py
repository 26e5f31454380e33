"""Field: known landmarks, and the camera's pose relative to them."""
