"""Writing of sheets as PNG. Edges are rounded to whole pixels, and the file states the size of a pixel."""

from __future__ import annotations

import struct
import zlib

import numpy as np

from roverkit.vision.opencv import cv2
from roverkit.vision.printing.sheet import Sheet
from roverlink.runtime.core.errors import SetupError

_INCH = 0.0254
_HEADER = 8 + 25
"""Bytes of the PNG signature and of the first chunk, IHDR."""
_LARGEST = 30_000
"""Largest side in pixels; a larger image is a mistake."""


def to_png(sheet: Sheet, dpi: float) -> bytes:
    """Return a sheet as PNG with `dpi` pixels per inch. Raises `SetupError` if the image would be too large."""
    scale = dpi / _INCH
    width, height = round(sheet.width * scale), round(sheet.height * scale)
    if max(width, height) > _LARGEST:
        raise SetupError(f"the image would have {width}x{height} pixels; write a PDF, or use fewer than {dpi:g} DPI")
    image = np.full((height, width), 255, np.uint8)
    for rectangle in sheet.rectangles:
        # Round the edges, not the widths, so that neighbours share an edge without gaps.
        left, right = round(rectangle.left * scale), round((rectangle.left + rectangle.width) * scale)
        top, bottom = round(rectangle.top * scale), round((rectangle.top + rectangle.height) * scale)
        image[top:bottom, left:right] = 0
    for label in sheet.labels:
        size = cv2.getFontScaleFromHeight(cv2.FONT_HERSHEY_SIMPLEX, max(1, round(label.height * scale)))
        place = (round(label.left * scale), round(label.base * scale))
        cv2.putText(image, label.text, place, cv2.FONT_HERSHEY_SIMPLEX, size, 0, 1, cv2.LINE_AA)
    return _with_resolution(bytes(cv2.imencode(".png", image)[1]), scale)


def _with_resolution(png: bytes, pixels_a_metre: float) -> bytes:
    """Return a PNG with the chunk pHYs added, which states the size of a pixel (PNG specification, 11.3.5.3).

    OpenCV does not write this chunk.
    """
    # Pixels per unit in x and y; unit 1 is the metre. The checksum of a chunk covers its name and its data.
    data = b"pHYs" + struct.pack(">IIB", round(pixels_a_metre), round(pixels_a_metre), 1)
    chunk = struct.pack(">I", len(data) - 4) + data + struct.pack(">I", zlib.crc32(data))
    return png[:_HEADER] + chunk + png[_HEADER:]
