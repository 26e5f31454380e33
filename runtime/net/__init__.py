"""UDP sockets, system calls for batches of datagrams, access control by sender address, and an HTTP server."""
