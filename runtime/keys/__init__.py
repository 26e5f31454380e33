"""Keys for signed datagrams: the files with the keys, and the timestamps that survive a restart."""
