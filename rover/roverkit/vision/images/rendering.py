"""Renderer of images for tests: printed planes as a camera sees them, at exactly known poses.

Each pixel is the mean of several rays. A ray starts at a point of the sensor, passes the inverse of the lens distortion
and the pinhole, and gets the grey value of the print where it meets the plane. The rays are blurred with the point
spread function of the lens before their mean is computed. Then noise is added, and the result is rounded to 8 bits.
Integer coordinates are the centres of pixels.

This module imports nothing from the rest of the package. An error there can therefore not hide itself in the test
images.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.opencv import cv2

Floats = NDArray[np.floating[Any]]
Grey = NDArray[np.uint8]

RAYS = 5
"""Number of rays per pixel along each axis; their grey values are averaged."""
PSF_SIGMA = 0.8
"""Standard deviation of the lens's blur in pixels (point spread function); the area of a pixel adds more blur."""
NOISE_SIGMA = 2.0
"""Standard deviation of the noise in grey levels."""
_MARGIN = 5  # pixels around a print that its blurred edge may reach
_TILE = 64  # side in pixels of the tiles that are rendered together, so that the data fits in the CPU's cache
_BENDING_STEPS = 4  # fixed-point steps; each one reduces the error by the slope of the paper
_OUTLINE = 16  # points per side of a print's outline, since the lens bends it


@dataclass(frozen=True, slots=True)
class Lens:
    """Camera with OpenCV's distortion coefficients: k1 k2 p1 p2 k3, and k4 k5 k6 of a rational model.

    If `fisheye` is true, the coefficients are k1 k2 k3 k4 of OpenCV's fisheye model. `matrix` is the 3x3 camera matrix
    in pixels, `size` is (width, height) of the image.
    """

    matrix: Floats
    distortion: tuple[float, ...]
    size: tuple[int, int]
    fisheye: bool = False

    def distorted(self, rays: Floats) -> Floats:
        """Return the pixels (..., 2) at which the camera sees rays (..., 2). A ray is a point in the plane z = 1."""
        x, y = rays[..., 0], rays[..., 1]
        bent_x, bent_y = self._fisheye(x, y) if self.fisheye else self._rational(x, y)
        (fx, _, cx), (_, fy, cy), _ = self.matrix
        return np.stack([fx * bent_x + cx, fy * bent_y + cy], axis=-1)

    def rays(self, pixels: Floats) -> Floats:
        """Return the rays (..., 2) that the camera sees at pixels (..., 2), by Newton's method on `distorted`."""
        focal = self.matrix.diagonal()[:2]
        rays = (pixels - self.matrix[:2, 2]) / focal
        step = 1e-6
        for _ in range(50):
            seen = self.distorted(rays)
            miss = pixels - seen
            if np.abs(miss / focal).max() < 1e-12:
                break
            by_x, by_y = ((self.distorted(rays + step * axis) - seen) / step for axis in np.eye(2))
            determinant = by_x[..., 0] * by_y[..., 1] - by_y[..., 0] * by_x[..., 1]
            change_x = by_y[..., 1] * miss[..., 0] - by_y[..., 0] * miss[..., 1]
            change_y = by_x[..., 0] * miss[..., 1] - by_x[..., 1] * miss[..., 0]
            rays = rays + np.stack([change_x, change_y], axis=-1) / determinant[..., None]
        return rays

    def _rational(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        k1, k2, p1, p2, k3, k4, k5, k6 = self.distortion + (0.0,) * (8 - len(self.distortion))
        r2 = x * x + y * y
        radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
        bent_x = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
        return bent_x, y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y

    def _fisheye(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        k1, k2, k3, k4 = self.distortion
        r = np.maximum(np.hypot(x, y), 1e-12)
        angle = np.arctan(r)
        a2 = angle * angle
        scale = angle * (1 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4)))) / r
        return x * scale, y * scale


@dataclass(frozen=True, slots=True)
class Print:
    """Plane with a print on it, such as a marker on a sheet of paper, given by the image of the print.

    The origin of its frame is its centre; x points right, y up on the page, z out of it.
    """

    image: Grey
    metres_per_pixel: float
    curvature: float = 0.0
    """Curvature in 1/m of paper that is bent about the y axis of the print; the paper touches the plane at x = 0."""

    @property
    def half_size(self) -> tuple[float, float]:
        """Half of the width and half of the height of the print in metres."""
        rows, columns = self.image.shape
        return columns / 2 * self.metres_per_pixel, rows / 2 * self.metres_per_pixel


@dataclass(frozen=True, slots=True)
class Pose:
    """Pose of a plane: `rotation` (3x3) and `translation` (3, metres) from the plane's frame to the camera's.

    The camera's frame is the optical one: x right, y down and z forward.
    """

    rotation: Floats
    translation: Floats


def marker_print(dictionary: int, number: int, side: float, *, texels: int = 24) -> Print:
    """Return the print of a marker whose outer edges are `side` metres apart, with a white border of one module.

    A module is one black or white cell of a marker. `texels` is the number of pixels of the print's image along a side
    of a module. The renderer sends several rays through each camera pixel; `texels` should be about the number of rays
    along a side of the module (see `texels_for`).
    """
    bits = cv2.aruco.getPredefinedDictionary(dictionary)
    modules = bits.markerSize + 2
    pattern = np.pad(np.asarray(bits.generateImageMarker(number, modules)), 1, constant_values=255)
    grey = np.where(pattern > 127, 225, 25).astype(np.uint8)
    return Print(np.kron(grey, np.ones((texels, texels), np.uint8)), side / modules / texels)


def texels_for(side_px: float) -> int:
    """Return the texels (pixels of the print's image) per module for a marker that is seen `side_px` pixels wide.

    The marker has 7 modules along a side. The number is somewhat less than the number of rays per module.
    """
    return max(4, round(0.75 * RAYS * side_px / 7))


def texture(size: tuple[int, int], rng: np.random.Generator) -> Floats:
    """Return a scene without markers, as a background: noise at all scales, boxes, lines and chequered patterns."""
    width, height = size
    scene = np.full((height, width), rng.uniform(80, 170))
    for cell in (160, 80, 40, 20, 10, 5, 2):
        noise = rng.normal(0, 5 + cell**0.5, (height // cell + 2, width // cell + 2)).astype(np.float32)
        scene += cv2.resize(noise, (width, height), interpolation=cv2.INTER_CUBIC)
    scene = scene.astype(np.float32)
    for _ in range(60):
        _scribble(scene, rng)
    blurred: Floats = np.clip(cv2.GaussianBlur(scene, (0, 0), PSF_SIGMA), 0, 255).astype(np.float64)
    return blurred


def _scribble(scene: NDArray[np.float32], rng: np.random.Generator) -> None:
    height, width = scene.shape
    x, y = int(rng.integers(width)), int(rng.integers(height))
    grey = float(rng.uniform(0, 255))
    kind = rng.integers(3)
    if kind == 0:
        corners = cv2.boxPoints(((x, y), tuple(rng.uniform(8, 90, 2)), rng.uniform(0, 90)))
        cv2.fillConvexPoly(scene, corners.astype(np.int32), grey)
    elif kind == 1:
        end = rng.integers(-120, 120, 2) + np.array([x, y])
        cv2.line(scene, (x, y), (int(end[0]), int(end[1])), grey, int(rng.integers(1, 6)))
    else:
        cells, cell = rng.integers(0, 2, (6, 6)), int(rng.integers(2, 9))
        block = np.kron(cells, np.ones((cell, cell))) * 180 + 40
        place = scene[y : y + block.shape[0], x : x + block.shape[1]]
        place[:] = block[: place.shape[0], : place.shape[1]]


def render(
    lens: Lens,
    background: Floats,
    planes: Sequence[tuple[Print, Pose]],
    rng: np.random.Generator,
    *,
    psf_sigma: float = PSF_SIGMA,
    noise_sigma: float = NOISE_SIGMA,
) -> Grey:
    """Return an image of prints in front of a background (height, width). The background must be blurred already.

    A print hides the prints that stand before it in `planes`.
    """
    return expose(render_light(lens, background, planes, psf_sigma=psf_sigma), rng, noise_sigma)


def render_light(
    lens: Lens, background: Floats, planes: Sequence[tuple[Print, Pose]], *, psf_sigma: float = PSF_SIGMA
) -> NDArray[np.float32]:
    """Return the light (height, width) on the sensor in grey levels, without noise; see `render`."""
    frame = background.astype(np.float32)
    for plane, pose in planes:
        _paint(frame, lens, plane, pose, psf_sigma)
    return frame


def expose(light: NDArray[np.float32], rng: np.random.Generator, noise_sigma: float = NOISE_SIGMA) -> Grey:
    """Return the image of 8 bits that a sensor makes of the light on it."""
    noisy = light + np.float32(noise_sigma) * rng.standard_normal(light.shape, np.float32)
    image: Grey = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
    return image


def outline(lens: Lens, plane: Print, pose: Pose) -> Floats:
    """Return the pixels (N, 2) at which a camera sees points along the border of a print."""
    half_width, half_height = plane.half_size
    steps = np.linspace(-1, 1, _OUTLINE)
    ones = np.ones(_OUTLINE)
    rim = np.concatenate(
        [np.stack([steps, s * ones], -1) for s in (-1, 1)] + [np.stack([s * ones, steps], -1) for s in (-1, 1)]
    )
    return project(lens, pose, np.column_stack([rim * (half_width, half_height), np.zeros(len(rim))]))


def project(lens: Lens, pose: Pose, points: Floats) -> Floats:
    """Return the pixels (N, 2) at which a camera sees points (N, 3) in the frame of a plane; `pose` is the plane's."""
    seen = points @ pose.rotation.T + pose.translation
    return lens.distorted(seen[:, :2] / seen[:, 2:])


def _paint(frame: NDArray[np.float32], lens: Lens, plane: Print, pose: Pose, psf_sigma: float) -> None:
    height, width = frame.shape
    rim = outline(lens, plane, pose)
    left, top = np.maximum(np.floor(rim.min(axis=0)).astype(int) - _MARGIN, 0)
    right, bottom = np.minimum(np.ceil(rim.max(axis=0)).astype(int) + _MARGIN + 1, (width, height))
    before = frame.copy()
    for row in range(top, bottom, _TILE):
        for column in range(left, right, _TILE):
            tile = (slice(row, min(row + _TILE, bottom)), slice(column, min(column + _TILE, right)))
            around = tuple(slice(max(part.start - _MARGIN, 0), part.stop + _MARGIN) for part in tile)
            inside = tuple(
                slice(part.start - whole.start, part.stop - whole.start) for part, whole in zip(tile, around)
            )
            rays = _ray_grid(lens, around[1].start, around[0].start, *before[around].shape[::-1])
            frame[tile] = _painted(before[around], plane, pose, rays, psf_sigma)[inside]


def _painted(
    place: NDArray[np.float32], plane: Print, pose: Pose, rays: Floats, psf_sigma: float
) -> NDArray[np.float32]:
    """Return a part (H, W) of the frame with a print drawn into it.

    The outer `_MARGIN` pixels of the part are inexact.
    """
    grey, cover = _sample(plane, pose, rays)
    if not cover.any():
        return place
    behind = cv2.resize(place, None, fx=RAYS, fy=RAYS, interpolation=cv2.INTER_LINEAR)
    seen = behind + cover * (grey - behind)
    blurred = cv2.GaussianBlur(seen, (0, 0), psf_sigma * RAYS, borderType=cv2.BORDER_REPLICATE)
    mean = blurred.reshape(place.shape[0], RAYS, place.shape[1], RAYS).mean(axis=(1, 3))
    near = cv2.GaussianBlur(cover, (0, 0), psf_sigma * RAYS).reshape(*place.shape[:1], RAYS, -1, RAYS).max(axis=(1, 3))
    painted: NDArray[np.float32] = np.where(near > 1e-4, mean, place)  # the background is blurred already
    return painted


def _ray_grid(lens: Lens, left: int, top: int, width: int, height: int) -> Floats:
    """Return the rays (height * RAYS, width * RAYS, 2) of a part of the image.

    They are exact at the corners of pixels and linearly interpolated between them.
    """
    x, y = np.meshgrid(np.arange(width + 1) + left - 0.5, np.arange(height + 1) + top - 0.5)
    # The inverse of the distortion needs many steps. Within a pixel, the lens is linear to some ten-thousandths of
    # a pixel.
    corners = lens.rays(np.stack([x, y], axis=-1))
    return _between(_between(corners, 0), 1)


def _between(borders: Floats, axis: int) -> Floats:
    """Interpolate values, given at the borders of pixels along an axis, to `RAYS` positions in each pixel."""
    places = (np.arange((borders.shape[axis] - 1) * RAYS) + 0.5) / RAYS
    low = places.astype(np.intp)
    part = np.expand_dims(places - low, tuple(range(1, borders.ndim - axis)))
    values: Floats = borders.take(low, axis) * (1 - part) + borders.take(low + 1, axis) * part
    return values


def _sample(plane: Print, pose: Pose, rays: Floats) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the grey values (H, W) that rays (H, W, 2) see on a print, and the share (0 to 1) of the print in each."""
    to_plane = np.linalg.inv(np.column_stack([pose.rotation[:, :2], pose.translation]))
    x, y, w = np.moveaxis(rays @ to_plane[:, :2].T + to_plane[:, 2], -1, 0)
    x, y = _on_bent_paper(plane, pose, rays, x / w, y / w)
    rows, columns = plane.image.shape
    column = x / plane.metres_per_pixel + columns / 2 - 0.5
    row = -y / plane.metres_per_pixel + rows / 2 - 0.5
    rim = np.minimum(np.minimum(column, columns - 1 - column), np.minimum(row, rows - 1 - row)) + 1  # in texels
    cover = np.where(w > 0, np.clip(rim, 0, 1), 0)
    column, row = np.clip(column, 0, columns - 1), np.clip(row, 0, rows - 1)
    c, r = np.minimum(column.astype(int), columns - 2), np.minimum(row.astype(int), rows - 2)
    a, b = (column - c).astype(np.float32), (row - r).astype(np.float32)
    image = plane.image.astype(np.float32)
    grey = (1 - b) * ((1 - a) * image[r, c] + a * image[r, c + 1])
    grey += b * ((1 - a) * image[r + 1, c] + a * image[r + 1, c + 1])
    return grey, cover.astype(np.float32)


def _on_bent_paper(plane: Print, pose: Pose, rays: Floats, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return the points (x, y) at which rays meet bent paper, given the points at which they meet its plane."""
    if not plane.curvature:
        return x, y
    along = rays @ pose.rotation[:2] + pose.rotation[2]  # directions in the frame of the plane
    flat_x, flat_y = x, y
    for _ in range(_BENDING_STEPS):
        height = -plane.curvature / 2 * x * x
        x, y = flat_x + height * along[..., 0] / along[..., 2], flat_y + height * along[..., 1] / along[..., 2]
    return x, y
