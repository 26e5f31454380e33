"""Rendered scenes with rocks and maintenance panels: images, depths, and the true boxes and positions of the objects.

The shipped model is trained with them, and the demo and tests play them. Rocks are shaded drawings that stand on the
ground; the parts of a panel are drawings on a plane. Light, colours, blur, noise and JPEG's losses are random. All
randomness comes from a seed, so a scene can be made again.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverlink.vision.camera.camera_model import CameraParameters, Floats
from roverlink.vision.markers.detection import Image
from roverlink.vision.objects.detected_objects import Box
from roverlink.vision.objects.panel_parts import PARTS, SIDE, draw_part
from roverlink.vision.opencv import cv2
from roverlink.vision.poses.pose import Pose

CLASSES = ("rock", *PARTS)
"""Names of the classes; they are those of the enum DetectedObjectType."""
SIZE = _WIDTH, _HEIGHT = 640, 480
"""Width and height of all images in pixels."""
CAMERA = CameraParameters(np.array([[600.0, 0, 319.5], [0, 600, 239.5], [0, 0, 1]]), np.zeros(5), size=SIZE)
"""Camera of all scenes."""
_VISIBLE = 0.3
"""Least part of an object's pixels that must be visible; others have no box."""
_SMALLEST = 9
"""Least width and height of a box in pixels."""
_FAR = 12.0  # metres; what is further away is sky
_SPRITE = 128  # side of the drawing of a rock in pixels
_PANEL = (900, 640)  # width and height of a panel in millimetres, which are pixels of its drawing
_TILE = 1024  # side of the drawing of the ground in pixels, which is repeated
_TILE_M = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class SceneObject:
    """Object with its truth."""

    number: int
    """Number of the object in its world, from 1."""
    class_name: str
    box: Box
    """Box around its visible pixels."""
    position: Floats
    """Middle (3,) of the side that faces the camera, in the optical frame, in metres."""


@dataclass(frozen=True, slots=True, eq=False)
class RenderedScene:
    """Image with its truth."""

    image: Image
    """BGR image (480, 640, 3)."""
    depth: NDArray[np.float32]
    """Depth (480, 640) in metres; NaN for the sky."""
    objects: tuple[SceneObject, ...]
    camera: Pose
    """Transform from the optical frame to the world: x ahead, y to the left, z up (REP 103)."""


def scenes(seed: int, count: int) -> Iterator[RenderedScene]:
    """Yield independent scenes: about as many with rocks as with panels."""
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        world = _Rocks(rng) if rng.random() < 0.5 else _Panel(rng)
        yield world.seen_from(world.place(rng), rng, _Look(rng))


def sequence(seed: int, count: int, *, panel: bool) -> Iterator[RenderedScene]:
    """Yield the frames of a camera that moves past a panel, or past rocks; each object keeps its number."""
    rng = np.random.default_rng([seed, int(panel)])
    world = _Panel(rng) if panel else _Rocks(rng)
    look = _Look(rng)
    first, last = world.way(rng)
    for step in np.linspace(0, 1, count):
        sway = 0.004 * np.sin(np.array([31, 23, 17]) * step)
        pose = _looking(first[0] + step * (last[0] - first[0]) + sway, first[1] + step * (last[1] - first[1]))
        yield world.seen_from(pose, rng, look)


def _looking(eye: Floats, target: Floats) -> Pose:
    """Return the pose of a camera without roll that looks at a point of the world."""
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, [0.0, 0, 1])
    right /= np.linalg.norm(right)
    return Pose(np.column_stack([right, np.cross(ahead, right), ahead]), eye)


def _smooth(rng: np.random.Generator, shape: tuple[int, int], cells: int) -> Floats:
    """Return noise (H, W) that is smooth over cells, with mean 0 and standard deviation 1; it can be repeated."""
    small = rng.normal(size=(cells, cells)).astype(np.float32)
    wrapped = np.pad(small, 2, mode="wrap")
    scale = shape[1] / cells
    large = cv2.resize(wrapped, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC)
    cut = round(2 * scale)
    noise: Floats = large[cut : cut + shape[0], cut : cut + shape[1]]
    return noise / max(float(noise.std()), 1e-6)


class _Look:
    """Light and errors of a camera, which stay equal in a sequence."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.light = rng.uniform(-1, 1, 2)
        self.gain = rng.uniform(0.55, 1.25)
        self.gamma = rng.uniform(0.8, 1.25)
        self.tint = rng.uniform(0.9, 1.1, 3)
        self.gradient = rng.uniform(-0.3, 0.3, 2)
        self.blur = rng.uniform(0.3, 1.3)
        self.motion = int(rng.integers(2, 8)) if rng.random() < 0.2 else 0
        self.noise = rng.uniform(1, 7)
        self.quality = int(rng.integers(35, 96))

    def apply(self, image: Floats, rng: np.random.Generator) -> Image:
        """Return the image of a camera for exact colours (H, W, 3) from 0 to 255."""
        x, y = np.linspace(-1, 1, _WIDTH, dtype=np.float32), np.linspace(-1, 1, _HEIGHT, dtype=np.float32)
        light = self.gain * (1 + self.gradient[0] * x + self.gradient[1] * y[:, None])
        lit = 255 * (np.clip(image / 255 * light[..., None] * self.tint, 0, 1) ** self.gamma)
        lit = cv2.GaussianBlur(lit.astype(np.float32), (0, 0), self.blur)
        if self.motion:
            lit = cv2.blur(lit, (self.motion, 1))
        noise = cv2.resize(rng.normal(0, self.noise, (_HEIGHT // 2, _WIDTH // 2, 3)), (_WIDTH, _HEIGHT)) + rng.normal(
            0, self.noise / 2, (_HEIGHT, _WIDTH, 3)
        )
        shown = np.clip(lit + noise, 0, 255).astype(np.uint8)
        _, data = cv2.imencode(".jpg", shown, [cv2.IMWRITE_JPEG_QUALITY, self.quality])
        decoded: Image = cv2.imdecode(data, cv2.IMREAD_COLOR)
        return decoded


class _Canvas:
    """Image, depth and objects while a scene is drawn, from the far to the near."""

    def __init__(self, pose: Pose) -> None:
        self.pose = pose
        columns, rows = np.meshgrid(np.arange(_WIDTH), np.arange(_HEIGHT))
        rays = np.dstack([(columns - CAMERA.centre[0]) / CAMERA.focal[0], (rows - CAMERA.centre[1]) / CAMERA.focal[1]])
        self.rays: Floats = np.dstack([rays, np.ones((_HEIGHT, _WIDTH))]) @ pose.rotation.T
        """Directions (H, W, 3) in the world, with the length 1 along the optical axis."""
        self.image = np.zeros((_HEIGHT, _WIDTH, 3), np.float32)
        self.depth = np.full((_HEIGHT, _WIDTH), np.nan, np.float32)
        self.numbers = np.zeros((_HEIGHT, _WIDTH), np.int32)
        self.whole: dict[int, float] = {}
        """Number of pixels that each object would have if nothing hid it."""

    def meet(self, point: Floats, normal: Floats) -> Floats:
        """Return the depths (H, W) at which the rays meet a plane; NaN where they do not."""
        slope = self.rays @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            depth: Floats = ((point - self.pose.translation) @ normal) / slope
        depth[~((depth > 0.05) & (depth < _FAR))] = np.nan
        return depth

    def seen(self, point: Floats) -> Floats:
        """Return a point of the world in the optical frame."""
        return self.pose.inverse().apply(point)


class _World:
    """Objects and their surroundings."""

    def __init__(self, rng: np.random.Generator) -> None:
        red = rng.uniform(60, 210)
        green = red * rng.uniform(0.6, 1.02)
        self._ground = np.array([green * rng.uniform(0.55, 1.0), green, red])  # from grey to sand and red
        coarse, fine = _smooth(rng, (_TILE, _TILE), 24), _smooth(rng, (_TILE, _TILE), 256)
        grain = rng.normal(size=(_TILE, _TILE))
        shade = 1 + rng.uniform(0.03, 0.12) * coarse + rng.uniform(0.02, 0.1) * fine + rng.uniform(0.01, 0.08) * grain
        self._tile = np.clip(self._ground * shade[..., None], 0, 255).astype(np.float32)
        self._sky = rng.uniform(120, 240) * np.array([1.0, 0.95, 0.9]) * rng.uniform(0.9, 1.1, 3)

    def _draw_ground(self, canvas: _Canvas) -> None:
        depth = canvas.meet(np.zeros(3), np.array([0.0, 0, 1]))
        places = canvas.pose.translation + depth[..., None] * canvas.rays
        scaled = np.nan_to_num(places[..., :2] / _TILE_M * _TILE).astype(np.float32)
        colours = cv2.remap(self._tile, scaled[..., 0], scaled[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
        haze = np.nan_to_num(np.clip(depth / _FAR, 0, 1), nan=1.0)[..., None] ** 2
        canvas.image[:] = (1 - haze) * colours + haze * np.where(np.isnan(depth)[..., None], self._sky, self._ground)
        canvas.depth[:] = depth

    def _draw(self, canvas: _Canvas, look: _Look) -> None:
        raise NotImplementedError

    def _objects(self) -> list[tuple[str, Floats]]:
        """Return the class of each object, and the middle (3,) of its front."""
        raise NotImplementedError

    def place(self, rng: np.random.Generator) -> Pose:
        """Return a random pose of the camera from which objects can be seen."""
        eye, target = self.way(rng)[0]
        return _looking(eye, target)

    def way(self, rng: np.random.Generator) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """Return the places of the camera, and the points at which it looks, at the begin and the end of a drive."""
        raise NotImplementedError

    def seen_from(self, pose: Pose, rng: np.random.Generator, look: _Look) -> RenderedScene:
        """Return the scene as a camera sees it."""
        canvas = _Canvas(pose)
        self._draw_ground(canvas)
        self._draw(canvas, look)
        found = []
        for number, (name, front) in enumerate(self._objects(), 1):
            rows, columns = np.nonzero(canvas.numbers == number)
            if rows.size < _VISIBLE * canvas.whole.get(number, np.inf):
                continue
            left, top, right, bottom = columns.min(), rows.min(), columns.max() + 1, rows.max() + 1
            if min(right - left, bottom - top) >= _SMALLEST:
                box = Box(float(left), float(top), float(right - left), float(bottom - top))
                found.append(SceneObject(number, name, box, canvas.seen(front)))
        return RenderedScene(look.apply(canvas.image, rng), canvas.depth, tuple(found), pose)


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


class _Rocks(_World):
    """Rocks on the ground, about 2 m ahead."""

    def __init__(self, rng: np.random.Generator) -> None:
        super().__init__(rng)
        self._rocks: list[_Rock] = []
        for _ in range(rng.integers(1, 9)):
            place = np.array([rng.uniform(0.9, 4.5), rng.uniform(-1.4, 1.4)])
            radius = rng.uniform(0.05, 0.25)
            if all(np.linalg.norm(place - one.place) > 0.7 * (radius + one.radius) for one in self._rocks):
                self._rocks.append(_rock(rng, place, radius, self._ground))

    def _draw(self, canvas: _Canvas, look: _Look) -> None:
        order = sorted(range(len(self._rocks)), key=lambda one: -self._seen(canvas, self._rocks[one])[2])
        for index in order:
            _shade_ground(canvas, self._rocks[index], look)
        for index in order:
            _draw_rock(canvas, self._rocks[index], self._seen(canvas, self._rocks[index]), index + 1, look)

    @staticmethod
    def _seen(canvas: _Canvas, rock: _Rock) -> Floats:
        return canvas.seen(np.append(rock.place, 0.8 * rock.radius * rock.flat))

    def _objects(self) -> list[tuple[str, Floats]]:
        return [("rock", np.append(one.place - (one.radius, 0), 0.8 * one.radius * one.flat)) for one in self._rocks]

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
    relief = relief + 0.05 * rng.uniform(0.5, 1.6) * _smooth(rng, (_SPRITE, _SPRITE), 8)
    relief = relief + 0.02 * rng.uniform(0.3, 1.5) * _smooth(rng, (_SPRITE, _SPRITE), 32)
    grey = rng.uniform(50, 190)
    colour = np.clip(0.6 * grey * rng.uniform(0.9, 1.1, 3) + 0.4 * ground * rng.uniform(0.6, 1.3), 15, 235)
    return _Rock(place, radius, rng.uniform(0.5, 0.95), colour, distance, relief)


def _shade_ground(canvas: _Canvas, rock: _Rock, look: _Look) -> None:
    """Darken the ground at the side of a rock that is turned away from the light."""
    places = canvas.pose.translation[:2] + canvas.depth[..., None] * canvas.rays[..., :2]
    middle = rock.place - 0.5 * rock.radius * look.light
    away = np.linalg.norm(places - middle, axis=-1) / rock.radius
    dark = 0.55 * np.clip(1.6 - away, 0, 1)
    canvas.image *= 1 - np.nan_to_num(dark).astype(np.float32)[..., None]


def _draw_rock(canvas: _Canvas, rock: _Rock, middle: Floats, number: int, look: _Look) -> None:
    """Draw a rock at its middle (3,) in the optical frame."""
    if middle[2] < 0.2:
        return
    width = max(4, round(2 * 1.15 * rock.radius * CAMERA.focal[0] / middle[2]))
    height = max(4, round(width * rock.flat))
    size = width, height
    distance, relief = (cv2.resize(one, size, interpolation=cv2.INTER_AREA) for one in (rock.outline, rock.relief))
    slope_y, slope_x = np.gradient(relief * width / 2.3)
    length = np.sqrt(slope_x**2 + slope_y**2 + 1)
    # The light comes from the side of `light`, and from above.
    lit = (0.75 * look.light[1] * slope_x + 0.9 * slope_y + 0.7) / length
    shade = 0.35 + 0.75 * np.clip(lit, 0, 1.2)
    left, top = np.rint(CAMERA.project(middle) - (width / 2, height / 2)).astype(int).tolist()
    x1, y1, x2, y2 = max(left, 0), max(top, 0), min(left + width, _WIDTH), min(top + height, _HEIGHT)
    inside = distance < 1
    canvas.whole[number] = float(np.count_nonzero(inside))
    if x1 >= x2 or y1 >= y2:
        return
    part = np.s_[y1 - top : y2 - top, x1 - left : x2 - left]
    image, mask = np.s_[y1:y2, x1:x2], inside[part]
    canvas.image[image][mask] = (rock.colour * shade[part][..., None])[mask]
    canvas.depth[image][mask] = (middle[2] - rock.radius * relief[part])[mask]
    canvas.numbers[image][mask] = number


class _Panel(_World):
    """Panel with parts, 2 m ahead; its plane is x = 2, its lower edge stands above the ground."""

    _AHEAD, _LOW = 2.0, 0.3

    def __init__(self, rng: np.random.Generator) -> None:
        super().__init__(rng)
        width, height = _PANEL
        base = rng.uniform(40, 235)
        colour = base * rng.uniform(0.88, 1.12, 3)
        shade = 1 + 0.03 * _smooth(rng, (height, width), 20)[..., None]
        self._drawing = np.clip(colour * shade, 0, 255).astype(np.uint8)
        self._numbers = np.zeros((height, width), np.uint8)
        self._parts: list[tuple[str, int, int]] = []
        self._decorate(rng)
        for _ in range(rng.integers(6, 70)):
            x, y = rng.integers(SIDE // 2, width - SIDE // 2), rng.integers(SIDE // 2, height - SIDE // 2)
            name = str(rng.choice(list(PARTS)))
            self._add(name, int(x), int(y), rng)

    def _decorate(self, rng: np.random.Generator) -> None:
        """Draw what is no object: an edge, bolts, and lines of text."""
        width, height = _PANEL
        cv2.rectangle(self._drawing, (0, 0), (width - 1, height - 1), rng.integers(20, 120, 3).tolist(), 8)
        for _ in range(rng.integers(0, 14)):
            x, y = int(rng.integers(30, width - 150)), int(rng.integers(30, height - 30))
            ink = rng.integers(0, 255, 3).tolist()
            if rng.random() < 0.5:
                text = "".join(chr(code) for code in rng.integers(48, 91, rng.integers(2, 8)))
                cv2.putText(self._drawing, text, (x, y), 0, rng.uniform(0.5, 1.0), ink, 2, cv2.LINE_AA)
            else:
                cv2.circle(self._drawing, (x, y), int(rng.integers(3, 8)), ink, -1)

    def _add(self, name: str, x: int, y: int, rng: np.random.Generator) -> None:
        """Add a part, turned at random, if it has enough space."""
        drawing, mask = draw_part(name, rng)
        scale = rng.uniform(0.85, 1.15)
        turn = cv2.getRotationMatrix2D((SIDE / 2, SIDE / 2), float(rng.normal(0, 4)), scale)
        drawing, mask = (cv2.warpAffine(one, turn, (SIDE, SIDE), flags=cv2.INTER_NEAREST) for one in (drawing, mask))
        half = SIDE // 2
        area = np.s_[y - half : y + half, x - half : x + half]
        grown = cv2.dilate(mask, np.ones((17, 17), np.uint8))
        if (self._numbers[area] * grown).any():
            return
        inside = mask > 0
        self._parts.append((name, x, y))
        self._drawing[area][inside] = drawing[inside]
        self._numbers[area][inside] = len(self._parts)

    def _draw(self, canvas: _Canvas, look: _Look) -> None:  # noqa: ARG002  # as for rocks
        depth = canvas.meet(np.array([self._AHEAD, 0, 0]), np.array([1.0, 0, 0]))
        places = canvas.pose.translation + depth[..., None] * canvas.rays
        width, height = _PANEL
        across, down = width / 2 - 1000 * places[..., 1], height + 1000 * (self._LOW - places[..., 2])
        x, y = (np.nan_to_num(one, nan=-1e6).astype(np.float32) for one in (across, down))
        # Millimetres in a pixel: the drawing is made as coarse, as the area of a pixel would.
        coarse = float(np.nanmedian(depth)) / CAMERA.focal[0] * 1000
        drawing = cv2.GaussianBlur(self._drawing, (0, 0), 0.45 * coarse) if coarse > 1 else self._drawing
        colours = cv2.remap(drawing, x, y, cv2.INTER_LINEAR)
        on = (x >= 0) & (x < width) & (y >= 0) & (y < height) & (depth < np.nan_to_num(canvas.depth, nan=_FAR))
        numbers = cv2.remap(self._numbers, x, y, cv2.INTER_NEAREST)
        canvas.image[on] = colours[on]
        canvas.depth[on] = depth[on]
        canvas.numbers[on] = numbers[on]
        for number, (_, front) in enumerate(self._objects(), 1):
            seen = canvas.seen(front)
            if seen[2] > 0.1:
                # The normal of the panel is x: seen from the side, its parts are narrower.
                tilt = abs(float((front - canvas.pose.translation)[0])) / float(np.linalg.norm(seen))
                millimetres = np.count_nonzero(self._numbers == number)
                canvas.whole[number] = millimetres * tilt * (CAMERA.focal[0] / 1000 / seen[2]) ** 2

    def _objects(self) -> list[tuple[str, Floats]]:
        width, height = _PANEL
        return [
            (
                name,
                np.array(
                    [self._AHEAD, (width / 2 - x) / 1000, height / 1000 + self._LOW - y / 1000],
                ),
            )
            for name, x, y in self._parts
        ]

    def way(self, rng: np.random.Generator) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """Return the places of the camera, and the points at which it looks, at the begin and the end of a drive."""
        near = rng.uniform(0.55, 1.5)
        side, high = rng.uniform(-0.6, 0.6) * near, rng.uniform(0.4, 0.9)
        eye = np.array([self._AHEAD - near, side, high])
        target = np.array([self._AHEAD, rng.uniform(-0.25, 0.25), self._LOW + rng.uniform(0.2, 0.45)])
        moved = np.array([0.1, -1.4 * side, 0.05]), np.array([0, -0.5 * target[1], 0.02])
        return (eye, target), (eye + moved[0], target + moved[1])


def degraded(depth: NDArray[Any], rng: np.random.Generator) -> NDArray[np.uint16]:
    """Return a depth image as a stereo camera publishes it: in millimetres, with noise of 1 % and holes (0)."""
    noisy = depth * (1 + rng.normal(0, 0.01, depth.shape))
    noisy[cv2.resize(rng.random((60, 80)), (_WIDTH, _HEIGHT)) > 0.93] = np.nan
    return np.nan_to_num(np.rint(1000 * noisy)).astype(np.uint16)
