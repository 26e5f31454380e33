"""World of rocks on the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from roverkit.objects.scenes.rendered_camera import CAMERA, HEIGHT, WIDTH, Canvas, ImagingConditions
from roverkit.objects.scenes.world import World, smooth
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.opencv import cv2

_SPRITE = 128  # side of the drawing of a rock in pixels


@dataclass(frozen=True, slots=True, eq=False)
class _Rock:
    """Rock on the ground."""

    place: Floats
    """Middle (2,) on the ground."""
    radius: float
    flat: float
    """Height divided by width."""
    colour: Floats
    outline: Floats
    """Distance (S, S) from the middle, divided by that of the outline in the same direction."""
    relief: Floats
    """Height (S, S) of the surface towards the camera."""


class RocksOnGround(World):
    """Rocks on the ground, about 2 m ahead."""

    def __init__(self, rng: np.random.Generator) -> None:
        super().__init__(rng)
        self._rocks: list[_Rock] = []
        for _ in range(rng.integers(1, 9)):
            place = np.array([rng.uniform(0.9, 4.5), rng.uniform(-1.4, 1.4)])
            radius = rng.uniform(0.05, 0.25)
            if all(np.linalg.norm(place - rock.place) > 0.7 * (radius + rock.radius) for rock in self._rocks):
                self._rocks.append(_rock(rng, place, radius, self.ground))

    def _draw(self, canvas: Canvas, conditions: ImagingConditions) -> None:
        order = sorted(range(len(self._rocks)), key=lambda index: -self._seen(canvas, self._rocks[index])[2])
        for index in order:
            _shade_ground(canvas, self._rocks[index], conditions)
        for index in order:
            _draw_rock(canvas, self._rocks[index], self._seen(canvas, self._rocks[index]), index + 1, conditions)

    @staticmethod
    def _seen(canvas: Canvas, rock: _Rock) -> Floats:
        return canvas.seen(np.append(rock.place, 0.8 * rock.radius * rock.flat))

    def _objects(self) -> list[tuple[str, Floats]]:
        return [
            ("rock", np.append(rock.place - (rock.radius, 0), 0.8 * rock.radius * rock.flat)) for rock in self._rocks
        ]

    def way(self, rng: np.random.Generator) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """Return the places of the camera, and the points at which it looks, at the begin and the end of a drive."""
        height, turn = rng.uniform(0.35, 0.9), rng.uniform(-0.6, 0.6)
        eye, target = np.array([0.0, turn, height]), np.array([rng.uniform(1.2, 2.8), 0.5 * turn, 0.1])
        forward = np.array([0.5, 0, 0])
        return (eye, target), (eye + forward - (0, 1.2 * turn, 0), target + forward - (0, turn, 0))


def _rock(rng: np.random.Generator, place: Floats, radius: float, ground: Floats) -> _Rock:
    """Return a rock with a random outline, relief and colour."""
    grid = np.linspace(-1.15, 1.15, _SPRITE)
    x, y = np.meshgrid(grid, grid)
    angle = np.arctan2(y, x)
    outline = np.ones_like(x)
    for wave in range(2, 8):
        outline += rng.normal(0, 0.22 / wave) * np.cos(wave * angle + rng.uniform(0, 2 * np.pi))
    distance = np.hypot(x, y) / np.clip(outline, 0.6, 1.12)
    relief = np.sqrt(np.clip(1 - distance**2, 0, 1))
    relief = relief + 0.05 * rng.uniform(0.5, 1.6) * smooth(rng, (_SPRITE, _SPRITE), 8)
    relief = relief + 0.02 * rng.uniform(0.3, 1.5) * smooth(rng, (_SPRITE, _SPRITE), 32)
    grey = rng.uniform(50, 190)
    colour = np.clip(0.6 * grey * rng.uniform(0.9, 1.1, 3) + 0.4 * ground * rng.uniform(0.6, 1.3), 15, 235)
    return _Rock(place, radius, rng.uniform(0.5, 0.95), colour, distance, relief)


def _shade_ground(canvas: Canvas, rock: _Rock, conditions: ImagingConditions) -> None:
    """Darken the ground at the side of a rock that is turned away from the light."""
    places = canvas.pose.translation[:2] + canvas.depth[..., None] * canvas.rays[..., :2]
    middle = rock.place - 0.5 * rock.radius * conditions.light
    away = np.linalg.norm(places - middle, axis=-1) / rock.radius
    dark = 0.55 * np.clip(1.6 - away, 0, 1)
    canvas.image *= 1 - np.nan_to_num(dark).astype(np.float32)[..., None]


def _draw_rock(canvas: Canvas, rock: _Rock, middle: Floats, number: int, conditions: ImagingConditions) -> None:
    """Draw a rock at its middle (3,) in the optical frame."""
    if middle[2] < 0.2:
        return
    width = max(4, round(2 * 1.15 * rock.radius * CAMERA.focal[0] / middle[2]))
    height = max(4, round(width * rock.flat))
    size = width, height
    distance, relief = (cv2.resize(image, size, interpolation=cv2.INTER_AREA) for image in (rock.outline, rock.relief))
    slope_y, slope_x = np.gradient(relief * width / 2.3)
    length = np.sqrt(slope_x**2 + slope_y**2 + 1)
    # The light comes from the side of `light`, and from above.
    lit = (0.75 * conditions.light[1] * slope_x + 0.9 * slope_y + 0.7) / length
    shade = 0.35 + 0.75 * np.clip(lit, 0, 1.2)
    left, top = np.rint(CAMERA.project(middle) - (width / 2, height / 2)).astype(int).tolist()
    x1, y1, x2, y2 = max(left, 0), max(top, 0), min(left + width, WIDTH), min(top + height, HEIGHT)
    inside = distance < 1
    canvas.whole[number] = float(np.count_nonzero(inside))
    if x1 >= x2 or y1 >= y2:
        return
    part = np.s_[y1 - top : y2 - top, x1 - left : x2 - left]
    image, mask = np.s_[y1:y2, x1:x2], inside[part]
    canvas.image[image][mask] = (rock.colour * shade[part][..., None])[mask]
    canvas.depth[image][mask] = (middle[2] - rock.radius * relief[part])[mask]
    canvas.numbers[image][mask] = number
