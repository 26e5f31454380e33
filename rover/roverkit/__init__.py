"""Programs of a rover's computer that feed roverlink: cameras, objects, video, driving, odometry and missions."""

import os

# numpy's OpenBLAS starts a thread on each core for a larger product of matrices. The products here are too small to
# gain from it, and the threads spin for some 20 ms before they sleep: with a frame of markers every 33 ms, on all cores
# all the time. It reads this variable when numpy is imported, and who has set it already knows better.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
