"""Checks of ROS 2 launch files: a catalogue of packages, the expansion of launch files, and the rules about both."""

if __name__ != "roverlink.launch_check":
    raise ImportError("'launch_check' is a folder of this repository, not a package; import roverlink.launch_check")
