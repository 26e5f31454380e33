"""UDP sockets, addresses, and who may speak."""
