"""Prints markers and boards to true scale: as PDF, whose shapes are exact, and as PNG at a resolution."""

from vision.printing.layout import PAPERS, board_sheet, marker_sheets
from vision.printing.pdf import to_pdf
from vision.printing.png import to_png
from vision.printing.sheet import Sheet

__all__ = ["PAPERS", "Sheet", "board_sheet", "marker_sheets", "to_pdf", "to_png"]
