"""The command line and the parameters of the ROS 2 node."""
