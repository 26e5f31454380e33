"""Implementation of ``roverlink odometry``: where the rover is, from what the driving board and an IMU report."""
