"""Reading of the ROS 2 arguments of the node (those after ``--ros-args``), and of the node's parameters."""
