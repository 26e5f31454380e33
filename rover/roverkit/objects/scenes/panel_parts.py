"""Drawings of the parts of a maintenance panel: switches, sockets and so on, in many looks.

Each function draws one part around the middle of a canvas (BGR), whose pixels are millimetres, with colours and
proportions from a random generator.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2

SIDE = 160
"""Width and height of the canvas on which a part is drawn."""
_MIDDLE = SIDE // 2

Colour = tuple[int, int, int]
Draw = Callable[[Image, np.random.Generator], None]


def draw_part(name: str, rng: np.random.Generator) -> tuple[Image, Image]:
    """Return a canvas (`SIDE`, `SIDE`, 3) with a part of `PARTS`, and a mask (`SIDE`, `SIDE`) of its pixels."""
    # Drawn on two grounds: what differs is not the part.
    state = rng.bit_generator.state
    canvases = []
    for ground in (0, 255):
        rng.bit_generator.state = state
        canvas = np.full((SIDE, SIDE, 3), ground, np.uint8)
        PARTS[name](canvas, rng)
        canvases.append(canvas)
    mask = (canvases[0] == canvases[1]).all(axis=2)
    return canvases[0], mask.astype(np.uint8)


def _grey(rng: np.random.Generator, low: int, high: int) -> Colour:
    """Return a grey with a slight tint."""
    blue, green, red = np.clip(rng.integers(low, high) + rng.integers(-8, 9, 3), 0, 255).tolist()
    return blue, green, red


def _vivid(rng: np.random.Generator, hues: tuple[int, ...]) -> Colour:
    """Return a strong colour with one of the hues of OpenCV, from 0 to 179."""
    hue = (int(rng.choice(hues)) + int(rng.integers(-5, 6))) % 180
    pixel = np.array([[[hue, rng.integers(170, 256), rng.integers(130, 246)]]], np.uint8)
    blue, green, red = cv2.cvtColor(pixel, cv2.COLOR_HSV2BGR)[0, 0].tolist()
    return blue, green, red


def _darker(colour: Colour, part: float) -> Colour:
    blue, green, red = (int(part * value) for value in colour)
    return blue, green, red


def _disk(canvas: Image, radius: float, colour: Colour, at: tuple[float, float] = (0, 0)) -> None:
    place = round(_MIDDLE + at[0]), round(_MIDDLE + at[1])
    cv2.circle(canvas, place, round(radius), colour, -1, cv2.LINE_8)


def _plate(canvas: Image, width: float, height: float, colour: Colour) -> None:
    half = round(width / 2), round(height / 2)
    first, last = (_MIDDLE - half[0], _MIDDLE - half[1]), (_MIDDLE + half[0], _MIDDLE + half[1])
    cv2.rectangle(canvas, first, last, colour, -1)
    cv2.rectangle(canvas, first, last, _darker(colour, 0.6), 2)


def _bar(canvas: Image, length: float, width: float, angle: float, colour: Colour, start: float = -1.0) -> None:
    """Draw a bar through the middle; `start` and 1 are its ends in half lengths."""
    way = np.array([np.cos(angle), np.sin(angle)]) * length / 2
    first, last = (np.rint(_MIDDLE + end * way).astype(int).tolist() for end in (start, 1.0))
    cv2.line(canvas, first, last, colour, round(width), cv2.LINE_8)


def _screws(canvas: Image, x: float, y: float, rng: np.random.Generator) -> None:
    colour = _grey(rng, 60, 130)
    for at in ((-x, -y), (x, -y), (-x, y), (x, y)):
        _disk(canvas, 4, colour, at)
        _disk(canvas, 1.5, (30, 30, 30), at)


def _main_switch(canvas: Image, rng: np.random.Generator) -> None:
    """Draw a yellow plate with a large red knob."""
    side = rng.uniform(80, 110)
    _plate(canvas, side, side, _vivid(rng, (26, 28)))
    _disk(canvas, side * 0.40, (25, 25, 25))
    red = _vivid(rng, (0, 178))
    _disk(canvas, side * 0.36, red)
    angle = float(rng.choice([0, np.pi / 2]) + rng.normal(0, 0.1))
    _bar(canvas, side * 0.66, side * 0.2, angle, _darker(red, 0.7))
    _bar(canvas, side * 0.6, 5, angle, (240, 240, 240), 0.2)


def _switch(canvas: Image, rng: np.random.Generator) -> None:
    """Draw a small dark plate with a lever or a rocker, up or down."""
    width = rng.uniform(32, 46)
    height = width * rng.uniform(1.4, 1.8)
    _plate(canvas, width, height, _grey(rng, 20, 70))
    up = -1 if rng.random() < 0.5 else 1
    if rng.random() < 0.5:
        _disk(canvas, width * 0.25, _grey(rng, 150, 210))
        _bar(canvas, height * 0.75, width * 0.2, up * np.pi / 2, _grey(rng, 200, 250), 0.0)
    else:
        half = height * 0.36
        for sign, low in ((up, 70), (-up, 140)):
            first = (round(_MIDDLE - width * 0.3), round(_MIDDLE + min(0, sign * half)))
            last = (round(_MIDDLE + width * 0.3), round(_MIDDLE + max(0, sign * half)))
            cv2.rectangle(canvas, first, last, _grey(rng, low, low + 60), -1)


def _rotary_switch(canvas: Image, rng: np.random.Generator) -> None:
    """Draw a round dial with marks and a thin pointer."""
    radius = rng.uniform(30, 42)
    _disk(canvas, radius, _grey(rng, 190, 240))
    angle = rng.uniform(0, 2 * np.pi)
    for mark in np.linspace(0, 2 * np.pi, 8, endpoint=False):
        _bar(canvas, radius * 1.9, 3, mark, (40, 40, 40), 0.8)
    _disk(canvas, radius * 0.62, _grey(rng, 40, 90))
    _bar(canvas, radius * 1.1, 5, angle, (235, 235, 235), 0.1)


def _rotary_power_switch(canvas: Image, rng: np.random.Generator) -> None:
    """Draw a black plate with a wide bar as handle."""
    side = rng.uniform(66, 88)
    _plate(canvas, side, side, _grey(rng, 15, 50))
    _disk(canvas, side * 0.42, _grey(rng, 90, 140))
    _bar(
        canvas, side * 0.8, side * 0.26, float(rng.choice([0.0, np.pi / 4, np.pi / 2])), _vivid(rng, (0, 178, 60, 110))
    )


def _socket(canvas: Image, rng: np.random.Generator) -> None:
    """Draw a socket: a square frame with a round cavity and two holes."""
    side = rng.uniform(62, 84)
    frame = _grey(rng, 200, 250) if rng.random() < 0.7 else _vivid(rng, (105, 112))
    _plate(canvas, side, side, frame)
    _disk(canvas, side * 0.40, _darker(frame, 0.75))
    _disk(canvas, side * 0.36, _darker(frame, 0.88))
    angle = rng.choice([0.0, np.pi / 2])
    for sign in (-1, 1):
        at = sign * side * 0.17 * np.cos(angle), sign * side * 0.17 * np.sin(angle)
        _disk(canvas, side * 0.06, (20, 20, 20), at)


def _electromagnet(canvas: Image, rng: np.random.Generator) -> None:
    """Draw a metal disk with a dark ring and a screw."""
    radius = rng.uniform(28, 42)
    for part in np.linspace(1, 0.72, 6):
        _disk(canvas, radius * part, _grey(rng, round(110 + 110 * (1 - part)), round(150 + 160 * (1 - part))))
    _disk(canvas, radius * 0.66, (35, 30, 30))
    _disk(canvas, radius * 0.5, _grey(rng, 160, 210))
    _disk(canvas, radius * 0.16, (50, 50, 50))


def _plate_part(canvas: Image, rng: np.random.Generator) -> None:
    """Draw a metal plate with four screws and lines of text."""
    width = rng.uniform(90, 130)
    height = width * rng.uniform(0.45, 0.7)
    _plate(canvas, width, height, _grey(rng, 150, 215))
    _screws(canvas, width / 2 - 9, height / 2 - 9, rng)
    for line in (-0.15, 0.1):
        y = round(_MIDDLE + line * height)
        cv2.line(canvas, (round(_MIDDLE - width * 0.28), y), (round(_MIDDLE + width * 0.28), y), (60, 60, 60), 4)


def _cable(canvas: Image, rng: np.random.Generator) -> None:
    """Draw a curved cable with a plug at one end."""
    steps = np.linspace(0, 1, 40)[:, None]
    first, second, third, fourth = rng.uniform(-60, 60, (4, 2)) * (1, 0.8)
    first[0], fourth[0] = -60, 60
    curve = (1 - steps) ** 3 * first + 3 * (1 - steps) ** 2 * steps * second
    curve += 3 * (1 - steps) * steps**2 * third + steps**3 * fourth
    points = np.rint(_MIDDLE + curve).astype(np.int32)
    colour = _vivid(rng, (0, 110, 28, 60)) if rng.random() < 0.6 else _grey(rng, 15, 50)
    cv2.polylines(canvas, [points], False, colour, round(rng.uniform(7, 12)), cv2.LINE_8)
    cv2.rectangle(canvas, (points[-1] - 11).tolist(), (points[-1] + 11).tolist(), _grey(rng, 20, 60), -1)


PARTS: Mapping[str, Draw] = {
    "main_switch": _main_switch,
    "switch": _switch,
    "rotary_switch": _rotary_switch,
    "rotary_power_switch": _rotary_power_switch,
    "socket": _socket,
    "electromagnet": _electromagnet,
    "plate": _plate_part,
    "cable": _cable,
}
"""Function for each kind of part, by the name of its class."""
