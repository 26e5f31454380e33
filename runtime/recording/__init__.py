"""Recording of the datagrams and topics of a run to MCAP files, and reading of recordings.

A recording has two files. ``run.mcap`` holds the ROS 2 topics, in rosbag2's MCAP profile. ``run.datagrams.mcap`` holds
the datagrams exactly as they were sent or received, with the protobuf descriptors that are needed to parse them. There
are two files because rosbag2 and rosbags refuse a file that has a channel with another encoding than CDR.

The modules of this package need the mcap package.
"""

COMPRESSIONS = ("zstd", "lz4", "none")
EXPORTS = ("csv", "parquet")
