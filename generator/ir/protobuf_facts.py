"""Facts about protobuf that several steps need: field numbers, its own files, and protoc's Python modules."""

from __future__ import annotations

LARGEST_FIELD_NUMBER = 2**29 - 1
IMPLEMENTATION_NUMBERS = range(19_000, 20_000)
"""Field numbers that protobuf reserves for its implementation; protoc refuses them."""
OWN_FILES = "google/protobuf/"
"""Folder of the .proto files that come with protobuf."""


def module_path(file: str) -> str:
    """Return the path of a .proto file's module, without suffix: ``my_board/imu_pb2`` for ``my-board/imu.proto``."""
    # protoc makes folders of dots, as in github.com/owner/name.
    return f"{file.removesuffix('.proto').replace('-', '_').replace('.', '/')}_pb2"
