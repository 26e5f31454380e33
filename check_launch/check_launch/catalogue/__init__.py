"""Catalogue of ROS 2 packages: what their nodes have, for each supported ROS 2 distribution."""
