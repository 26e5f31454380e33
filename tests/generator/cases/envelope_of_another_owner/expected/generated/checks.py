# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The wire schema from which this code was generated, and its comparison with the loaded protobuf modules."""

from __future__ import annotations

from roverlink.runtime.core.descriptor_check import Fields, Values, check_descriptors

# The fields of each message: number, name and type.
MESSAGES: dict[str, Fields] = {
    "link.Datagram": (
        (1, "gps", "link.Gps"),
        (3, "imu", "link.Imu"),
        (100, "sequence", "uint32"),
    ),
    "link.Gps": ((1, "x", "double"),),
    "link.Imu": ((1, "x", "float"),),
}

# The values of each enum: number and name.
ENUMS: dict[str, Values] = {}


def check() -> None:
    """Raise `roverlink.runtime.RegistryError` if a loaded message or enum differs from the generated code."""
    check_descriptors(MESSAGES, ENUMS)
