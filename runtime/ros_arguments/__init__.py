"""What ROS 2 tells the node at its start: the arguments after ``--ros-args``, and the parameters among them."""
