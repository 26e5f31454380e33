"""ROS 2 arguments of the node: the arguments after ``--ros-args``, and the parameters among them."""
