"""The page on which a camera is calibrated, in a browser."""
