"""Program that extracts the catalogues from checkouts of the packages' sources.

``python -m roverlink.launch_check.extraction --help`` shows its options. No source is copied into the catalogues.
"""
