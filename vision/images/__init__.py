"""Images that are drawn, written as a film, or rendered."""
