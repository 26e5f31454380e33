# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The wire schema from which this code was generated, and its comparison with the loaded protobuf modules."""

from __future__ import annotations

from roverlink.runtime.core.descriptor_check import Fields, Values, check_descriptors

# The fields of each message: number, name and type.
MESSAGES: dict[str, Fields] = {
    "Envelope": (
        (1, "packet", "Packet"),
        (2, "imu", "sensors.IMU"),
    ),
    "Inner": (
        (1, "detail", "google.protobuf.Any"),
        (2, "stamp", "google.protobuf.Timestamp"),
    ),
    "Packet": (
        (1, "content", "google.protobuf.Any"),
        (2, "history", "repeated google.protobuf.Any"),
        (3, "named", "repeated Packet.NamedEntry"),
        (4, "raw", "google.protobuf.Any"),
        (5, "inner", "Inner"),
    ),
    "Packet.NamedEntry": (
        (1, "key", "string"),
        (2, "value", "google.protobuf.Any"),
    ),
    "google.protobuf.Any": (
        (1, "type_url", "string"),
        (2, "value", "bytes"),
    ),
    "google.protobuf.Timestamp": (
        (1, "seconds", "int64"),
        (2, "nanos", "int32"),
    ),
    "other.Gps2": ((1, "data", "bytes"),),
    "sensors.Gps": ((1, "latitude", "double"),),
    "sensors.IMU": ((1, "x", "float"),),
}

# The values of each enum: number and name.
ENUMS: dict[str, Values] = {}


def check() -> None:
    """Raise `roverlink.runtime.RegistryError` if a loaded message or enum differs from the generated code."""
    check_descriptors(MESSAGES, ENUMS)
