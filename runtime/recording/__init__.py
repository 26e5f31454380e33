"""A run on disk: what a bridge received, published, heard and sent, as MCAP files, and how it is read back.

A recording is two files. ``run.mcap`` has the ROS 2 topics, in the profile of rosbag2; ``run.datagrams.mcap`` beside it
has the datagrams as they were on the wire, with the protobuf descriptors that explain them. They are apart because
rosbag2 and rosbags refuse a file in which not everything is CDR.

What is in the modules below needs the mcap package, and raises `SetupError` on import where it is missing.
"""

COMPRESSIONS = ("zstd", "lz4", "none")
EXPORTS = ("csv", "parquet")
