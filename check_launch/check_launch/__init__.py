"""Checks of ROS 2 launch files: a catalogue of packages, the expansion of launch files, and the rules about both."""
