"""Training of a small detector from a folder in YOLO's format, and its export to ONNX. It needs jax, optax and onnx."""
