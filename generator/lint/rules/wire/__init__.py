"""Rules about changes that make two versions misread each other's bytes."""
