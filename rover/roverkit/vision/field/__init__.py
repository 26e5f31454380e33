"""Field: landmarks (markers and boards) with known poses, and the camera's pose relative to them."""
