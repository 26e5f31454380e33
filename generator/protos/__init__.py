"""The model of .proto files, and the two readers that fill it: protoc's descriptors and the tolerant parser."""
