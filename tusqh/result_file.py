"""A file of the results of a model: its name, path, content and columns."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ResultFile:
    """A file in the folder of a model's results.

    Parameters
    ----------
    name
        The name by which code refers to the file.
    path
        Path in the folder of the model.
    sentence
        A sentence on the content of the file.
    columns
        Columns of a table, for a solid; an outline has no ``k`` and ``z``.
    columns_of_materials
        The columns of a model of several materials, if they are others.
    """

    name: str
    path: str
    sentence: str
    columns: tuple[str, ...] = ()
    columns_of_materials: tuple[str, ...] = ()

    def columns_of(self, dimension: int) -> tuple[str, ...]:
        """Return the columns of the table for a geometry of a dimension.

        Parameters
        ----------
        dimension
            2 for an outline, 3 for a solid.

        Returns
        -------
        tuple of str
            The columns, in their order in the file.

        Examples
        --------
        >>> ResultFile("features", "features.csv", "...", columns("cells x y z")).columns_of(2)
        ('cells', 'x', 'y')
        """
        if dimension == 3:
            return self.columns
        return tuple(c for c in self.columns if not {"k", "z"} & set(c.split("_")))


def columns(*parts: str) -> tuple[str, ...]:
    """Return the names of columns that are separated by spaces.

    Parameters
    ----------
    *parts
        Texts with names.

    Returns
    -------
    tuple of str
        The names.

    Examples
    --------
    >>> columns("dimension birth", "death")
    ('dimension', 'birth', 'death')
    """
    return tuple(" ".join(parts).split())
