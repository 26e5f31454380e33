"""Conversion of the results of the camera programs to ROS 2 messages, and their publishing."""
