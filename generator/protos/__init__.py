"""The .proto files: one model of what they declare, and the two readers that fill it."""
