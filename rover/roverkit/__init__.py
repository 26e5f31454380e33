"""Programs of a rover's computer that feed roverlink: cameras, objects, video, driving, odometry and missions."""
