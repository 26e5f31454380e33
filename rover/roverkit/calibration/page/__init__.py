"""Web page on which a user calibrates a camera."""
