"""Messages, fields and enums of .proto files as data, and two readers for them: protoc and a tolerant parser."""
