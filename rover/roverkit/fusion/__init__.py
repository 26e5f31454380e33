"""Fusion of wheel odometry, landmarks and GPS on a plane, for computers without robot_localization."""
