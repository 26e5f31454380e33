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
from runtime.registry import Peer, Registry

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
    fingerprint="db70737703a5a843ff1a24a69af317a6adc17e234e441f6b2b5e055fab024a15",
    retired={},
)
