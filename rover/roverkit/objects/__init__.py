"""Detection and tracking of objects in images."""
