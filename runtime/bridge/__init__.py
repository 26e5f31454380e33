"""Bridge between UDP and ROS 2: datagrams of peers to topics, and topics to datagrams for peers."""
