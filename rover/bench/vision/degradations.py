"""Degradations of images and prints that covariances must survive: each one is a small function or a number.

Degradations of the light come before the noise of the sensor, and those of the image after it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from roverkit.vision.images.rendering import (
    Floats,
    Grey,
    Pose,
    Print,
    expose,
    marker_print,
    project,
    render_light,
    texels_for,
    texture,
)

from rover.bench.vision.scenes import DICTIONARY, FRAME_NS, SIDE, Scene, corner_points, lens, random_pose

Light = NDArray[np.float32]
READOUT_S = 0.02
"""Time in seconds from the first row of a rolling shutter to the last one."""
_SHARP = 4  # pixels of the print's image per pixel of the raster


def _as_it_is(light: Light, _: np.random.Generator) -> Light:
    return light


def _unchanged(image: Grey) -> Grey:
    return image


@dataclass(frozen=True, slots=True)
class Degradation:
    """Degradation of the frames of one row of the table."""

    name: str
    light: Callable[[Light, np.random.Generator], Light] = _as_it_is
    image: Callable[[Grey], Grey] = _unchanged
    raster: int = 0
    """Pixels per side of the image from which the marker is printed; 0 for a print with exact edges."""
    bend: float = 0.0
    """Height of the arch of bent paper across the marker, as a fraction of the side."""
    side: float = 1.0
    """Ratio of the true side of the marker to the side that the programs are given."""
    focal: float = 1.0
    """Ratio of the focal lengths that the programs are given to the true ones."""
    speed: float = 0.0
    """Speed of the image in pixels per second, seen by a rolling shutter."""
    highlight: float = 0.0
    """Light that a highlight adds at its middle, which is somewhere on the marker, as a fraction of full white."""


def gamma(light: Light, _: np.random.Generator) -> Light:
    """Encode linear light for a screen, with the exponent 1 / 2.2."""
    share: Light = np.clip(light, 0, 255) / np.float32(255)
    return np.asarray(255 * share ** np.float32(1 / 2.2), np.float32)


def white_balance(light: Light, _: np.random.Generator) -> Light:
    """Amplify red and blue, cut all channels off at 255, and return the grey value."""
    channels = [np.minimum(light * np.float32(gain), 255) for gain in (1.6, 1.15, 1.4)]
    grey: Light = 0.299 * channels[0] + 0.587 * channels[1] + 0.114 * channels[2]
    return grey


def jpeg(quality: int) -> Callable[[Grey], Grey]:
    """Return a function that compresses an image as JPEG and decompresses it."""

    def through(image: Grey) -> Grey:
        _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
        decoded: Grey = np.asarray(cv2.imdecode(data, cv2.IMREAD_GRAYSCALE), np.uint8)
        return decoded

    return through


def motion_blur(pixels: float) -> Callable[[Light, np.random.Generator], Light]:
    """Return a function that smears light evenly over a distance in pixels, in a random direction."""

    def smear(light: Light, rng: np.random.Generator) -> Light:
        angle = rng.uniform(0, np.pi)
        steps = 4 * int(np.ceil(pixels)) + 1
        smeared: Light = np.zeros_like(light)
        for part in (np.arange(steps) + 0.5) / steps - 0.5:
            smeared += _moved(light, pixels * part * np.array([np.cos(angle), np.sin(angle)]))
        smeared /= np.float32(steps)
        return smeared

    return smear


def defocus(radius: float) -> Callable[[Light, np.random.Generator], Light]:
    """Return a function that blurs light with the disc of a lens out of focus; its radius is in pixels."""

    def blur(light: Light, _: np.random.Generator) -> Light:
        reach, fine = int(np.ceil(radius)) + 1, 9
        places = (np.arange((2 * reach + 1) * fine) + 0.5) / fine - reach - 0.5
        disc = (places[:, None] ** 2 + places**2 <= radius**2).astype(np.float32)
        kernel = disc.reshape(2 * reach + 1, fine, 2 * reach + 1, fine).mean(axis=(1, 3))
        blurred: Light = cv2.filter2D(light, cv2.CV_32F, kernel / kernel.sum(), borderType=cv2.BORDER_REPLICATE)
        return blurred

    return blur


def rolling_shutter(light: Light, velocity: Floats, seconds: float) -> Light:
    """Return the light that rows see which are read one after the other, while the image moves.

    `velocity` is in pixels per second. `seconds` is the time of the middle row after the true pose.
    """
    height, width = light.shape
    x, y = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    later = seconds + READOUT_S * ((y + 0.5) / height - 0.5)
    return _remapped(light, x - velocity[0] * later, y - velocity[1] * later)


def raster_print(number: int, raster: int) -> Print:
    """Return a marker printed from an image of `raster` pixels, whose inner edges are rounded to whole pixels."""
    bits = cv2.aruco.getPredefinedDictionary(DICTIONARY)
    pattern = np.asarray(bits.generateImageMarker(number, raster))
    around = np.pad(pattern, round(raster / (bits.markerSize + 2)), constant_values=255)
    grey = np.where(around > 127, 225, 25).astype(np.uint8)
    return Print(np.kron(grey, np.ones((_SHARP, _SHARP), np.uint8)), SIDE / raster / _SHARP)


CLEAN = Degradation("clean")
DEGRADATIONS = (
    CLEAN,
    Degradation("gamma 2.2", light=gamma),
    Degradation("white balance, clipped", light=white_balance),
    Degradation("JPEG q75", image=jpeg(75)),
    Degradation("JPEG q20", image=jpeg(20)),
    Degradation("motion blur 3 px", light=motion_blur(3)),
    Degradation("motion blur 6 px", light=motion_blur(6)),
    Degradation("defocus 2.5 px", light=defocus(2.5)),
    Degradation("print of 200 px", raster=200),
    Degradation("print of 100 px", raster=100),
    Degradation("paper bent 2 %", bend=0.02),
    Degradation("side 1 % too small", side=0.99),
    Degradation("intrinsics 0.5 % off", focal=1.005),
    Degradation("rolling shutter 300 px/s", speed=300),
    Degradation("highlight 0.3", highlight=0.3),
    Degradation("highlight 0.7", highlight=0.7),
)


@dataclass(frozen=True, slots=True)
class DegradedScene:
    """Scene whose frame is degraded, with the frame before it if the image moves."""

    scene: Scene
    earlier: Grey | None


def degraded_scenes(degradation: Degradation, side_px: float, count: int, seed: int) -> Iterator[DegradedScene]:
    """Yield frames with one marker each. All degradations see the same markers at the same poses."""
    camera = lens()
    for index in range(count):
        rng = np.random.default_rng([seed, int(side_px), index])
        number, pose = int(rng.integers(250)), random_pose(camera, side_px, rng)
        scene = texture(camera.size, rng)
        if degradation.raster:
            plane = raster_print(number, degradation.raster)
        else:
            plane = marker_print(DICTIONARY, number, SIDE * degradation.side, texels=texels_for(side_px))
        # The true plane is the mean plane of bent paper; the arch touches a plane that is a third of its height above.
        plane = replace(plane, curvature=8 * degradation.bend / SIDE)
        bent = Pose(pose.rotation, pose.translation + pose.rotation[:, 2] * degradation.bend * SIDE / 3)
        light = degradation.light(render_light(camera, scene, [(plane, bent)]), rng)
        if degradation.highlight:
            middle = project(camera, pose, rng.uniform(-SIDE / 2, SIDE / 2, (1, 3)) * (1, 1, 0))[0]
            light = light + _highlight(light.shape, middle, side_px / 2) * np.float32(255 * degradation.highlight)
        earlier = None
        if degradation.speed:
            angle = rng.uniform(0, 2 * np.pi)
            velocity = degradation.speed * np.array([np.cos(angle), np.sin(angle)])
            earlier = expose(rolling_shutter(light, velocity, -FRAME_NS / 1e9), rng)
            light = rolling_shutter(light, velocity, 0.0)
        frame = degradation.image(expose(light, rng))
        yield DegradedScene(Scene(frame, number, pose, project(camera, pose, corner_points())), earlier)


def _highlight(shape: tuple[int, ...], middle: Floats, sigma: float) -> Light:
    """Return a bell (H, W) with its middle and standard deviation in pixels."""
    rows, columns = np.indices(shape, dtype=np.float32)
    bell: Light = np.exp(-((columns - middle[0]) ** 2 + (rows - middle[1]) ** 2) / np.float32(2 * sigma**2))
    return bell


def _moved(light: Light, shift: Floats) -> Light:
    height, width = light.shape
    x, y = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    return _remapped(light, x - shift[0], y - shift[1])


def _remapped(light: Light, x: Floats, y: Floats) -> Light:
    moved: Light = cv2.remap(
        light, x.astype(np.float32), y.astype(np.float32), cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE
    )
    return moved
