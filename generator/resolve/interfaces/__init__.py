"""Standard messages of ROS 2: their definitions, units, and meanings of zero."""
