"""Search for the dictionary to which the visible markers belong, if the chosen one has none of them."""

from __future__ import annotations

from roverkit.vision.camera.camera_model import CameraParameters
from roverkit.vision.markers.detection import Detector, Image, to_grey
from roverkit.vision.markers.edges import Guess
from roverkit.vision.markers.marker_fits import fit_markers
from roverkit.vision.markers.marker_set import MarkerSet, dictionaries


def other_dictionary(image: Image, camera: CameraParameters, chosen: MarkerSet | None) -> tuple[str, list[int]] | None:
    """Return the dictionary with the most markers in an image, (H, W) or (H, W, 3), and the numbers of these markers.

    Markers of the chosen dictionary do not count, if there is one. Of several dictionaries that contain the others, it
    is the smallest one. The result is None if no dictionary matches. This takes a second or two.
    """
    grey = to_grey(image)
    found = {name: _numbers(grey, camera, MarkerSet(name), chosen) for name in _families().values()}
    largest = max(found, key=lambda name: len(found[name]))
    numbers = found[largest]
    return (smallest(largest, max(numbers)), numbers) if numbers else None


def _numbers(grey: Image, camera: CameraParameters, markers: MarkerSet, others: MarkerSet | None) -> list[int]:
    """Return the numbers of the markers that match without a wrong bit, whose edges fit, and that `others` has not."""
    known = others.bits.bytesList.tolist() if others else []
    found = Detector(markers, exact=True).scan(grey)  # with correction, small dictionaries match many other squares
    fitted = fit_markers(grey, camera, [Guess(markers.pattern(marker.number), marker.corners) for marker in found])
    numbers = {marker.number for marker, fit in zip(found, fitted) if fit}
    return sorted(number for number in numbers if markers.bits.bytesList[number].tolist() not in known)


def _families() -> dict[str, str]:
    """Return the largest dictionary of each family; the smaller ones of a family contain its first markers."""
    sizes = dictionaries()
    return {_family(name): name for name in sorted(sizes, key=lambda name: sizes[name])}


def smallest(dictionary: str, number: int) -> str:
    """Return the smallest dictionary of the same family that contains a marker with this number."""
    sizes = dictionaries()
    fitting = [name for name in sizes if _family(name) == _family(dictionary) and sizes[name] > number]
    return min(fitting, key=lambda name: sizes[name])


def _family(name: str) -> str:
    start, _, end = name.rpartition("_")
    return start if end.isdecimal() else name
