"""Fix-its: declarations as a .proto file has them, and what to write so that nothing breaks."""
