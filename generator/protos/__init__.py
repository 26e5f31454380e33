"""Messages, fields and enums of .proto files as data, read by protoc or by a parser that tolerates mistakes."""
