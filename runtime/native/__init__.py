"""Native core: translation between protobuf's wire format and serialized ROS 2 messages, by a table."""
