"""ArUco markers: their definition, their detection in images, and their tracking from frame to frame."""
