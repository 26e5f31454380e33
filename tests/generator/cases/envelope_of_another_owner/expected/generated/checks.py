# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The wire schema from which this code was generated, and its check against what is loaded."""

from __future__ import annotations

from roverlink.runtime.core.descriptor_check import check_descriptors

MESSAGES = {
    "link.Datagram": (
        "1 gps link.Gps",
        "3 imu link.Imu",
        "100 sequence uint32",
    ),
    "link.Gps": ("1 x double",),
    "link.Imu": ("1 x float",),
}
ENUMS: dict[str, tuple[str, ...]] = {}


def check() -> None:
    """Raise `roverlink.runtime.RegistryError` where a loaded message is not the one that is meant."""
    check_descriptors(MESSAGES, ENUMS)
