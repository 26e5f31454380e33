"""The bridge: datagrams from the peers to topics, and topics to datagrams for the peers."""
