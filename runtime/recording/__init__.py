"""Recordings: datagrams and topics of a run as MCAP files, and reading them back.

A recording has two files. ``run.mcap`` holds the ROS 2 topics, in rosbag2's MCAP profile. ``run.datagrams.mcap`` holds
the datagrams as they were on the wire, with the protobuf descriptors that explain them. They are two because rosbag2
and rosbags refuse a file in which some channel is not CDR.

The modules of this package need the mcap package; importing them without it raises `SetupError`.
"""

COMPRESSIONS = ("zstd", "lz4", "none")
EXPORTS = ("csv", "parquet")
