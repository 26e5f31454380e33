"""Camera of rendered scenes: what is drawn into its image, and its errors."""

from __future__ import annotations

import numpy as np

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2
from roverkit.vision.poses.pose import Pose

SIZE = WIDTH, HEIGHT = 640, 480
"""Width and height of all images in pixels."""
CAMERA = CameraParameters(np.array([[600.0, 0, 319.5], [0, 600, 239.5], [0, 0, 1]]), np.zeros(5), size=SIZE)
"""Camera of all scenes."""
FAR = 12.0
"""Distance in metres from which on all is sky."""


class ImagingConditions:
    """Light and errors of a camera, which stay the same in a sequence."""

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
        x, y = np.linspace(-1, 1, WIDTH, dtype=np.float32), np.linspace(-1, 1, HEIGHT, dtype=np.float32)
        light = self.gain * (1 + self.gradient[0] * x + self.gradient[1] * y[:, None])
        lit = 255 * (np.clip(image / 255 * light[..., None] * self.tint, 0, 1) ** self.gamma)
        lit = cv2.GaussianBlur(lit.astype(np.float32), (0, 0), self.blur)
        if self.motion:
            lit = cv2.blur(lit, (self.motion, 1))
        noise = cv2.resize(rng.normal(0, self.noise, (HEIGHT // 2, WIDTH // 2, 3)), (WIDTH, HEIGHT)) + rng.normal(
            0, self.noise / 2, (HEIGHT, WIDTH, 3)
        )
        shown = np.clip(lit + noise, 0, 255).astype(np.uint8)
        _, data = cv2.imencode(".jpg", shown, [cv2.IMWRITE_JPEG_QUALITY, self.quality])
        decoded: Image = cv2.imdecode(data, cv2.IMREAD_COLOR)
        return decoded


class Canvas:
    """Image, depth and objects while a scene is drawn, from the far to the near."""

    def __init__(self, pose: Pose) -> None:
        self.pose = pose
        columns, rows = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
        rays = np.dstack([(columns - CAMERA.centre[0]) / CAMERA.focal[0], (rows - CAMERA.centre[1]) / CAMERA.focal[1]])
        self.rays: Floats = np.dstack([rays, np.ones((HEIGHT, WIDTH))]) @ pose.rotation.T
        """Directions (H, W, 3) in the world, with the length 1 along the optical axis."""
        self.image = np.zeros((HEIGHT, WIDTH, 3), np.float32)
        self.depth = np.full((HEIGHT, WIDTH), np.nan, np.float32)
        self.numbers = np.zeros((HEIGHT, WIDTH), np.int32)
        self.whole: dict[int, float] = {}
        """Number of pixels that each object would have if nothing hid it."""

    def meet(self, point: Floats, normal: Floats) -> Floats:
        """Return the depths (H, W) at which the rays meet a plane; NaN where they do not."""
        slope = self.rays @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            depth: Floats = ((point - self.pose.translation) @ normal) / slope
        depth[~((depth > 0.05) & (depth < FAR))] = np.nan
        return depth

    def seen(self, point: Floats) -> Floats:
        """Return a point of the world in the optical frame."""
        return self.pose.inverse().apply(point)
