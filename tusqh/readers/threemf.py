"""Read the solids of a 3MF file: objects, components, transforms and the unit."""

from __future__ import annotations

import zipfile
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from tusqh.errors import GeometryError
from tusqh.geometry.remark import Remark
from tusqh.geometry.soup import Part, Soup
from tusqh.geometry.units import unit_name
from tusqh.grid import FloatArray
from tusqh.readers.gate import require_memory
from tusqh.readers.polygon_faces import damaged
from tusqh.readers.reading import Reading
from tusqh.readers.xml_names import tag_of

_EXPECTED = "a complete 3MF file"
_RELATION = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
#: Deepest nesting of components, and most parts.
_DEEPEST, _MOST = 50, 100_000
#: Measured bytes of memory for each byte of XML.
_GROWTH = 12


def read(path: Path) -> Reading:
    """Read every object of the build as a part, once for each place where it is.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        The archive is damaged, has no model, or components refer to themselves.
    """
    return _Package(path).reading()


class _Package:
    """The models of a 3MF file."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.models: dict[str, dict[str, Element]] = {}
        self.left_out: Counter[str] = Counter()
        try:
            self.archive = zipfile.ZipFile(path)
        except zipfile.BadZipFile as error:
            raise damaged(path, str(error), expected=_EXPECTED) from error

    def reading(self) -> Reading:
        """Return the reading of the whole file."""
        with self.archive:
            main = self._main()
            root = self._parse(main)
            parts: list[Part] = []
            names: list[str] = []
            items = [e for e in root.iter() if tag_of(e) == "item"]
            for item in items:
                matrix = self._matrix(item)
                self._place(main, item.get("objectid", ""), matrix, parts, names, 0)
        unit = unit_name(root.get("unit", "millimeter"))
        remarks = [Remark("left out", what, n) for what, n in self.left_out.items() if n]
        if not parts:
            raise GeometryError(
                "the file has no solid in its build",
                where=str(self.path),
                expected="at least one object that is built",
                remedy="export the solids again, not only their slices or pictures",
            )
        soup = Soup.from_parts(parts, name=self.path.name, part_names=names)
        return Reading(soup, tuple(remarks), unit=unit)

    def _main(self) -> str:
        """Return the name of the main model."""
        names = self.archive.namelist()
        if "_rels/.rels" in names:
            for relation in self._xml("_rels/.rels"):
                if relation.get("Type") == _RELATION:
                    return relation.get("Target", "").lstrip("/")
        models = [name for name in names if name.lower().endswith(".model")]
        if not models:
            raise damaged(self.path, "the archive holds no model", expected=_EXPECTED)
        return models[0]

    def _xml(self, name: str) -> Element:
        """Return the root of a file of the archive."""
        try:
            size = self.archive.getinfo(name).file_size
            require_memory(self.path, _GROWTH * size, what=f"reading {size / 1e6:.1f} MB of XML")
            return ElementTree.fromstring(self.archive.read(name))
        except KeyError as error:
            raise damaged(self.path, f"it has no {name[:60]!r}", expected=_EXPECTED) from error
        except (zipfile.BadZipFile, ElementTree.ParseError, NotImplementedError) as error:
            raise damaged(self.path, f"{name[:60]!r}: {error}", expected=_EXPECTED) from error

    def _parse(self, name: str) -> Element:
        """Read a model, and keep its objects by their number."""
        root = self._xml(name)
        self.models[name] = {e.get("id", ""): e for e in root.iter() if tag_of(e) == "object"}
        self.left_out["lattices of beams"] += sum(tag_of(e) == "beamlattice" for e in root.iter())
        return root

    def _place(
        self,
        model: str,
        number: str,
        matrix: FloatArray,
        parts: list[Part],
        names: list[str],
        depth: int,
    ) -> None:
        """Add an object and its components at a place."""
        if model not in self.models:
            self._parse(model)
        found = self.models[model].get(number)
        if found is None or depth > _DEEPEST or len(parts) > _MOST:
            what = f"object {number!r} is missing" if found is None else "components never end"
            raise damaged(self.path, what, expected=_EXPECTED)
        if found.get("type", "model") in ("support", "other"):
            self.left_out["supports and other objects that are not solids"] += 1
            return
        for child in found:
            if tag_of(child) == "mesh":
                points, triangles = self._mesh(child)
                is_mirrored = np.linalg.det(matrix[:3]) < 0
                parts.append(
                    (
                        points @ matrix[:3] + matrix[3],
                        triangles[:, ::-1] if is_mirrored else triangles,
                    )
                )
                names.append(found.get("name", ""))
            elif tag_of(child) == "components":
                for component in child:
                    inner = self._matrix(component)
                    place = np.vstack([inner[:3] @ matrix[:3], inner[3] @ matrix[:3] + matrix[3]])
                    other = next((v for k, v in component.items() if k.endswith("}path")), "")
                    name = other.lstrip("/") or model
                    self._place(name, component.get("objectid", ""), place, parts, names, depth + 1)

    def _mesh(self, mesh: Element) -> Part:
        """Return the points and triangles of a mesh."""
        points = [
            [float(e.get(k, "nan")) for k in "xyz"] for e in mesh.iter() if tag_of(e) == "vertex"
        ]
        corners = [
            [int(e.get(k, "-1")) for k in ("v1", "v2", "v3")]
            for e in mesh.iter()
            if tag_of(e) == "triangle"
        ]
        return (
            np.array(points, dtype=np.float64).reshape(-1, 3),
            np.array(corners, dtype=np.int64).reshape(-1, 3),
        )

    def _matrix(self, element: Element) -> FloatArray:
        """Return the transform of an element, shape (4, 3), for points as rows."""
        text = element.get("transform")
        if text is None:
            return np.vstack([np.eye(3), np.zeros(3)])
        numbers = [float(word) for word in text.split()]
        if len(numbers) != 12 or not np.isfinite(numbers).all():
            raise damaged(self.path, f"the transform is {text[:60]!r}", expected=_EXPECTED)
        return np.array(numbers).reshape(4, 3)
