"""Command line of roverlink, a bridge between protobuf datagrams over UDP and ROS 2 topics.

The table ``mapping.yaml`` lists the messages that are bridged. `roverlink.generator` compiles the table into code,
`roverlink.runtime` runs the bridge with this code, and `roverkit.vision` contains the camera programs. Only the
command line uses all three packages.
"""
