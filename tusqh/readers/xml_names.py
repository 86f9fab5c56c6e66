"""Names of elements of XML, for the formats that are written in it."""

from __future__ import annotations

from xml.etree.ElementTree import Element


def tag_of(element: Element) -> str:
    """Return the name of an element without its namespace; empty for comments.

    Parameters
    ----------
    element
        The element.

    Examples
    --------
    >>> tag_of(Element("{http://www.opengis.net/kml/2.2}Placemark"))
    'Placemark'
    """
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""
