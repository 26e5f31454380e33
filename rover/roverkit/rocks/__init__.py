"""Sizes of rocks from a depth image and a line that somebody draws across a rock in the colour image.

try:
    size = measurement.measure(depth, camera, (181, 117, 260, 106))
except UnmeasurableError as error:
    print(error.reason.value, error)
else:
    print(size.length, size.width)
"""
