"""The signed area of an outline, and its remarks, for tests of readers."""

from tusqh.readers.files import read_file


def area_of(path):
    """Return the signed area of a file, by the shoelace formula."""
    outline = read_file(path).geometry
    (x0, y0), (x1, y1) = outline.points[outline.segments].transpose(1, 2, 0)
    return float((x0 * y1 - x1 * y0).sum()) / 2


def box_of(path):
    """Return the corners of the box around a file, as a list of four numbers."""
    low, high = read_file(path).geometry.bounding_box()
    return [*low, *high]


def remarks_of(path):
    """Return the remarks on a file, one per line."""
    return "\n".join(map(str, read_file(path).remarks))
