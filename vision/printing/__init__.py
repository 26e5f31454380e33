"""Printing of markers and boards in exact size: as PDF, or as PNG with a given resolution."""

from roverlink.vision.printing.pdf import to_pdf
from roverlink.vision.printing.png import to_png
from roverlink.vision.printing.sheet import Sheet
from roverlink.vision.printing.sheet_layout import PAPERS, board_sheet, marker_sheets

__all__ = ["PAPERS", "Sheet", "board_sheet", "marker_sheets", "to_pdf", "to_png"]
