# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The feeds: further topics of the rows, with messages of the common interfaces."""

from __future__ import annotations

from generated.feeds.weather_imu_data import WeatherImuDataFeed
from generated.feeds.weather_weather_humidity import WeatherWeatherHumidityFeed
from generated.feeds.weather_weather_light import WeatherWeatherLightFeed
from generated.feeds.weather_weather_pressure import WeatherWeatherPressureFeed
from generated.feeds.weather_weather_temperature import WeatherWeatherTemperatureFeed

__all__ = [
    "WeatherImuDataFeed",
    "WeatherWeatherHumidityFeed",
    "WeatherWeatherLightFeed",
    "WeatherWeatherPressureFeed",
    "WeatherWeatherTemperatureFeed",
]
