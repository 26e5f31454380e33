"""What was seen, as ROS 2 messages on topics."""
