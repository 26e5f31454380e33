"""Command line of roverlink, a bridge between protobuf datagrams over UDP and ROS 2 topics.

The table ``mapping.yaml`` lists the messages that are bridged. `roverlink.generator` compiles the table into code, and
`roverlink.runtime` runs the bridge with this code. Only the command line uses both packages.
"""
