"""Fix-its: declarations as a .proto file writes them, and edits that keep old bytes readable."""
