"""ROS 2 output of the camera programs."""
