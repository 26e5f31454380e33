"""Writing of sheets as PDF (ISO 32000). No library is used, because rectangles and text need only a few PDF operators.

Equal sheets give equal bytes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roverkit.vision.printing.sheet import Sheet

_POINTS = 72 / 0.0254
"""PDF units (points) per metre."""
_CAPITALS = 0.718
"""Height of Helvetica's capitals as a fraction of the font size (Adobe font metrics)."""
_FIRST_PAGE = 4  # object number; 1 to 3 are the catalogue, the page list and the font


def to_pdf(sheets: Sequence[Sheet]) -> bytes:
    """Return a PDF with one page for each sheet. At a scale of 100 % (actual size) it is printed in the exact size."""
    pages = " ".join(f"{_FIRST_PAGE + 2 * index} 0 R" for index in range(len(sheets)))
    objects = [
        # asks viewers not to shrink the page to the printable area
        "<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
        f"<< /Type /Pages /Kids [{pages}] /Count {len(sheets)} >>",
        "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
    ]
    for sheet in sheets:
        box = f"0 0 {_number(sheet.width)} {_number(sheet.height)}"
        content = "\n".join(_content(sheet))
        objects.append(
            f"<< /Type /Page /Parent 2 0 R /MediaBox [{box}] /Contents {len(objects) + 2} 0 R "
            "/Resources << /Font << /F 3 0 R >> >> >>"
        )
        objects.append(f"<< /Length {len(content)} >>\nstream\n{content}\nendstream")
    return _file(objects)


def _content(sheet: Sheet) -> Iterator[str]:
    yield "0 g"
    for rectangle in sheet.rectangles:
        bottom = sheet.height - rectangle.top - rectangle.height
        yield f"{_number(rectangle.left)} {_number(bottom)} {_number(rectangle.width)} {_number(rectangle.height)} re"
    yield "f"  # fill all shapes at once: viewers show seams between shapes that are filled separately
    for label in sheet.labels:
        size, place = _number(label.height / _CAPITALS), f"{_number(label.left)} {_number(sheet.height - label.base)}"
        yield f"BT /F {size} Tf {place} Td ({_escaped(label.text)}) Tj ET"


def _file(objects: Sequence[str]) -> bytes:
    body, places = "%PDF-1.6\n", []
    for number, text in enumerate(objects, 1):
        places.append(len(body))
        body += f"{number} 0 obj\n{text}\nendobj\n"
    # Entries have exactly 20 bytes, with the space before the line feed (ISO 32000-1, 7.5.4): readers compute their
    # places.
    table = "".join(f"{place:010} 00000 n \n" for place in places)
    size = len(objects) + 1
    body += f"xref\n0 {size}\n0000000000 65535 f \n{table}"
    body += f"trailer\n<< /Size {size} /Root 1 0 R >>\nstartxref\n{body.index('xref')}\n%%EOF\n"
    return body.encode("ascii")


def _number(metres: float) -> str:
    """Return a length as text in points (1/72 inch), accurate to a tenth of a micrometre."""
    return f"{metres * _POINTS:.4f}".rstrip("0").rstrip(".")


def _escaped(text: str) -> str:
    return text.replace("\\", r"\\").replace("(", r"\(").replace(")", r"\)")
