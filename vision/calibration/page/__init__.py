"""Web page for calibrating a camera."""
