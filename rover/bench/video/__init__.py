"""Benchmarks of video: latency, CPU, losses and priorities, beside GStreamer doing the same in the same run."""
