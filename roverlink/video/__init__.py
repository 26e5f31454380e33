"""Programs for video: the sender on the rover, and the receiver on the basestation with its page."""
