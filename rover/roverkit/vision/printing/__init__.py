"""Printing of markers and boards in exact size: as PDF, or as PNG with a given resolution."""

from roverkit.vision.printing.pdf import to_pdf
from roverkit.vision.printing.png import to_png
from roverkit.vision.printing.sheet import Sheet
from roverkit.vision.printing.sheet_layout import PAPERS, board_sheet, marker_sheets

__all__ = ["PAPERS", "Sheet", "board_sheet", "marker_sheets", "to_pdf", "to_png"]
