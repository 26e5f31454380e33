"""Implementation of ``roverlink fuse``: the rover's pose on the field from odometry, landmarks and GPS."""
