"""Standard messages of ROS 2: their definitions, their units, and the fields in which zero has a special meaning."""
