"""Read geometry files, with one module for each format.

`tusqh.readers.formats` is the table of all formats.  The module of a format is imported when a
file of that format is read, so that its library is needed only then.  It has one function,
``read(path) -> Reading``; readers of images also take the options of `tusqh.readers.voxels`.
A reader repairs nothing.

Later steps read the canonical file (`tusqh.geometry.canonical`) and import nothing from this
package, so a change in one reader reruns only the ingestion of models in its format.
"""
