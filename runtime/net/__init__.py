"""UDP sockets, system calls for batches, and access control by sender address."""
