"""Bridge between UDP and ROS 2: publishes datagrams of peers on topics, and sends messages of topics to peers."""
