"""Paths of the Python modules that protoc generates of .proto files."""

from __future__ import annotations


def module_path(file: str) -> str:
    """Return the path of a .proto file's module, without suffix: ``my_board/imu_pb2`` for ``my-board/imu.proto``."""
    return f"{file.removesuffix('.proto').replace('-', '_')}_pb2"
