# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

from __future__ import annotations

from generated.feeds import (
    WeatherImuDataFeed,
    WeatherWeatherHumidityFeed,
    WeatherWeatherLightFeed,
    WeatherWeatherPressureFeed,
    WeatherWeatherTemperatureFeed,
)
from generated.handlers import WeatherHandler
from generated.pb2 import envelope_pb2
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="rover",
    envelope=envelope_pb2.Envelope,
    oneof="payload",
    peers=(Peer(name="board", port_parameter="dst_a_port", port=6000),),
    handlers=(WeatherHandler(),),
    feeds=(
        WeatherWeatherPressureFeed(),
        WeatherWeatherTemperatureFeed(),
        WeatherWeatherHumidityFeed(),
        WeatherWeatherLightFeed(),
        WeatherImuDataFeed(),
    ),
    fingerprint="6c3b2014993949abaa9a7b01d0d39c155f9a050c65968d4cf75d28cb6158c558",
    retired={},
)
