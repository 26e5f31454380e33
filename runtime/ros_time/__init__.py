"""Time of a ROS 2 node: its clock, and the stamps in headers of messages."""
