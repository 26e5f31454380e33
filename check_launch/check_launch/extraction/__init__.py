"""Program that extracts the catalogues from checkouts of the packages' sources.

``python -m check_launch.extraction --help`` shows its options. No source is copied into the catalogues.
"""
