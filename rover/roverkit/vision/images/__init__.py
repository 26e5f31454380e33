"""Drawing on images, writing of videos, and rendering of artificial images."""
