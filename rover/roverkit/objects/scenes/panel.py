"""World of a maintenance panel that stands on the ground."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from roverkit.objects.scenes.panel_parts import PARTS, SIDE, draw_part
from roverkit.objects.scenes.rendered_camera import CAMERA, FAR, Canvas, ImagingConditions
from roverkit.objects.scenes.world import World, smooth
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.opencv import cv2

_PANEL = (900, 640)  # width and height of a panel in millimetres, which are pixels of its drawing


class Panel(World):
    """Panel with parts, 2 m ahead; its plane is x = 2, its lower edge stands above the ground."""

    _AHEAD, _LOW = 2.0, 0.3

    def __init__(self, rng: np.random.Generator) -> None:
        super().__init__(rng)
        width, height = _PANEL
        base = rng.uniform(40, 235)
        colour = base * rng.uniform(0.88, 1.12, 3)
        shade = 1 + 0.03 * smooth(rng, (height, width), 20)[..., None]
        self._drawing = np.clip(colour * shade, 0, 255).astype(np.uint8)
        self._numbers = np.zeros((height, width), np.uint8)
        self._parts: list[tuple[str, int, int]] = []
        self._decorate(rng)
        for _ in range(rng.integers(6, 70)):
            x, y = rng.integers(SIDE // 2, width - SIDE // 2), rng.integers(SIDE // 2, height - SIDE // 2)
            name = str(rng.choice(list(PARTS)))
            self._add(name, int(x), int(y), rng)

    def _decorate(self, rng: np.random.Generator) -> None:
        """Draw what is no object: an edge, labels, bolts, and frames around groups of parts."""
        width, height = _PANEL
        cv2.rectangle(self._drawing, (0, 0), (width - 1, height - 1), rng.integers(20, 120, 3).tolist(), 8)
        for _ in range(rng.integers(0, 16)):
            place = int(rng.integers(30, width - 60)), int(rng.integers(30, height - 30))
            ink = rng.integers(0, 255, 3).tolist()
            kind = rng.choice(["label", "bolt", "frame"], p=[0.6, 0.25, 0.15])
            if kind == "label":
                self._write_label(place, ink, rng)
            elif kind == "bolt":
                radius = int(rng.integers(3, 8))
                cv2.circle(self._drawing, place, radius, ink, -1, cv2.LINE_AA)
                cv2.circle(self._drawing, place, radius, (30, 30, 30), 1, cv2.LINE_AA)
            else:
                corner = place[0] + int(rng.integers(60, 400)), place[1] + int(rng.integers(60, 300))
                cv2.rectangle(self._drawing, place, corner, ink, int(rng.integers(1, 5)), cv2.LINE_AA)

    def _write_label(self, place: tuple[int, int], ink: Sequence[int], rng: np.random.Generator) -> None:
        """Write letters and digits, on a sticker or on the panel."""
        text = "".join(chr(code) for code in rng.integers(48, 91, rng.integers(1, 13)))
        font, scale, thick = int(rng.integers(0, 5)), rng.uniform(0.3, 1.2), int(rng.integers(1, 4))
        (width, height), below = cv2.getTextSize(text, font, scale, thick)
        if rng.random() < 0.3:
            margin = int(rng.integers(3, 10))
            top, bottom = place[1] - height - margin, place[1] + below + margin
            sticker = rng.integers(60, 255, 3).tolist()
            cv2.rectangle(self._drawing, (place[0] - margin, top), (place[0] + width + margin, bottom), sticker, -1)
        cv2.putText(self._drawing, text, place, font, scale, ink, thick, cv2.LINE_AA)

    def _add(self, name: str, x: int, y: int, rng: np.random.Generator) -> None:
        """Add a part, turned at random, if it has enough space."""
        drawing, mask = draw_part(name, rng)
        scale = rng.uniform(0.85, 1.15)
        turn = cv2.getRotationMatrix2D((SIDE / 2, SIDE / 2), float(rng.normal(0, 4)), scale)
        drawing, mask = (
            cv2.warpAffine(image, turn, (SIDE, SIDE), flags=cv2.INTER_NEAREST) for image in (drawing, mask)
        )
        half = SIDE // 2
        area = np.s_[y - half : y + half, x - half : x + half]
        grown = cv2.dilate(mask, np.ones((17, 17), np.uint8))
        if (self._numbers[area] * grown).any():
            return
        inside = mask > 0
        self._parts.append((name, x, y))
        self._drawing[area][inside] = drawing[inside]
        self._numbers[area][inside] = len(self._parts)

    def _draw(self, canvas: Canvas, conditions: ImagingConditions) -> None:  # noqa: ARG002  # as for rocks
        depth = canvas.meet(np.array([self._AHEAD, 0, 0]), np.array([1.0, 0, 0]))
        places = canvas.pose.translation + depth[..., None] * canvas.rays
        width, height = _PANEL
        across, down = width / 2 - 1000 * places[..., 1], height + 1000 * (self._LOW - places[..., 2])
        x, y = (np.nan_to_num(values, nan=-1e6).astype(np.float32) for values in (across, down))
        # Millimetres in a pixel: the drawing is made as coarse, as the area of a pixel would.
        coarse = float(np.nanmedian(depth)) / CAMERA.focal[0] * 1000
        drawing = cv2.GaussianBlur(self._drawing, (0, 0), 0.45 * coarse) if coarse > 1 else self._drawing
        colours = cv2.remap(drawing, x, y, cv2.INTER_LINEAR)
        on = (x >= 0) & (x < width) & (y >= 0) & (y < height) & (depth < np.nan_to_num(canvas.depth, nan=FAR))
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
