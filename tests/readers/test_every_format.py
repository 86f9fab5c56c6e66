"""One solid in every format, unit and orientation: the same mesh in the same place in metres."""

import itertools
import json

import ezdxf
import nrrd
import numpy as np
import pytest
import pyvista
import shapefile
import shapely
import tifffile
import trimesh
from PIL import Image as Pillow
from samples import (
    write_dicom,
    write_draco,
    write_geopackage,
    write_gml,
    write_metaimage,
    write_nifti,
    write_threemf,
)
from step_files import iges_patch, step_box

import tusqh
from tusqh.errors import GeometryError
from tusqh.geometry.units import METRES
from tusqh.readers.files import read_file
from tusqh.readers.formats import find_format, suffixes_of
from tusqh.settings.lengths import Lengths

#: A box in metres, with three lengths and away from 0.
LOW, HIGH = np.array([0.001, 0.002, 0.003]), np.array([0.005, 0.010, 0.009])


def box_in(unit):
    """Return the points and triangles of the box, in a unit."""
    box = trimesh.creation.box(bounds=[LOW, HIGH])
    return np.asarray(box.vertices) / METRES[unit], np.asarray(box.faces)


def check(path, *, precision=1e-6, **lengths):
    """Raise unless a file has the mesh of the box, in metres."""
    # Sides of the box lie on faces of cells, so that rounding does not change the mesh.
    grid = {"window": [(0, 0, 0), (0.006, 0.012, 0.010)], "cell_size": 0.001}
    expected = tusqh.mesh(box_in("m"), placement="corner", **grid).mesh
    found = tusqh.mesh(path, placement="corner", convert_to="m", **grid, **lengths).mesh
    assert found.unit == "m"
    assert np.array_equal(found.cells, expected.cells)
    assert found.points == pytest.approx(expected.points, abs=precision * 0.01)


@pytest.mark.parametrize("unit", ["mm", "m", "in"])
def test_surfaces_that_state_no_unit(tmp_path, unit):
    points, triangles = box_in(unit)
    mesh = trimesh.Trimesh(points, triangles, process=False)
    for suffix in ("stl", "obj", "ply", "off"):
        mesh.export(tmp_path / f"a.{suffix}")
        check(tmp_path / f"a.{suffix}", unit=unit)
    faces = np.column_stack([np.full(len(triangles), 3), triangles]).ravel()
    pyvista.PolyData(points, faces=faces).save(tmp_path / "a.vtp")
    check(tmp_path / "a.vtp", unit=unit)


def test_gltf_is_in_metres_compressed_or_not(tmp_path):
    points, triangles = box_in("m")
    trimesh.Trimesh(points, triangles).export(tmp_path / "a.glb")
    check(tmp_path / "a.glb")
    write_draco(tmp_path / "b.glb", points, triangles)
    check(tmp_path / "b.glb", precision=1e-5)


@pytest.mark.parametrize("unit", ["millimeter", "meter", "inch", "micron", "foot", "centimeter"])
@pytest.mark.parametrize("is_moved", [False, True])
def test_3mf_states_its_unit_and_has_transforms(tmp_path, unit, is_moved):
    name = {"millimeter": "mm", "meter": "m", "inch": "in", "micron": "um"}.get(unit, unit)
    name = {"foot": "ft", "centimeter": "cm"}.get(name, name)
    points, triangles = box_in(name)
    transform = None
    if is_moved:  # x, y, z become y, z, x, and 1 is added to x.
        transform = "0 1 0 0 0 1 1 0 0 1 0 0"
        points = (points - [1, 0, 0])[:, [1, 2, 0]]
    write_threemf(tmp_path / "a.3mf", points, triangles, unit=unit, transform=transform)
    assert read_file(tmp_path / "a.3mf").unit == name
    check(tmp_path / "a.3mf")


@pytest.mark.parametrize("unit", ["mm", "m", "in"])
def test_step_states_its_unit(tmp_path, unit):
    text = step_box(tuple(LOW / METRES[unit]), tuple(HIGH / METRES[unit]), unit=unit)
    (tmp_path / "a.step").write_text(text)
    reading = read_file(tmp_path / "a.step")
    assert (reading.unit, reading.unit_source) == (unit, "file")
    check(tmp_path / "a.step")
    with pytest.raises(GeometryError, match="the file states"):
        read_file(tmp_path / "a.step", lengths=Lengths(unit="km"))


@pytest.mark.parametrize("unit", ["MM", "M", "INCH"])
def test_iges_states_its_unit(tmp_path, unit):
    (tmp_path / "a.igs").write_text(iges_patch(2.0, 3.0, unit=unit))
    reading = read_file(tmp_path / "a.igs")
    assert reading.unit == {"INCH": "in"}.get(unit, unit.lower())
    assert reading.geometry.bounding_box()[1] == pytest.approx((2, 3, 0))


def test_step_without_a_solid_says_so(tmp_path):
    (tmp_path / "a.step").write_text(step_box((0.0, 0, 0), (1.0, 1, 1), is_empty=True))
    with pytest.raises(GeometryError, match="the file has no solid and no face") as caught:
        read_file(tmp_path / "a.step")
    assert "export the parts as solids" in caught.value.remedy
    (tmp_path / "b.step").write_text("ISO-10303-21;\nHEADER;\nENDSEC;\n")
    with pytest.raises(GeometryError, match="Open CASCADE cannot read it"):
        read_file(tmp_path / "b.step")


# Images: a block of voxels of 1 mm in an image of 6 x 11 x 10, whose first voxel begins at 0.
BLOCK = np.zeros((6, 11, 10), dtype=np.uint8)
BLOCK[1:5, 2:10, 3:9] = 1


def check_block(reading):
    """Raise unless an image has the block in its place."""
    image = reading.geometry
    fractions = image.fractions()
    assert fractions.sum() * image.voxel_size**3 == pytest.approx(4 * 8 * 6)
    there = np.argwhere(fractions > 0.5)
    low = image.origin + image.voxel_size * there.min(axis=0)
    high = image.origin + image.voxel_size * (there.max(axis=0) + 1)
    assert low == pytest.approx([1, 2, 3], abs=1e-5)
    assert high == pytest.approx([5, 10, 9], abs=1e-5)


TURNS = [
    (order, signs)
    for order in itertools.permutations(range(3))
    for signs in itertools.product((1, -1), repeat=3)
]


@pytest.mark.parametrize("suffix", ["nrrd", "nhdr", "nii", "nii.gz", "mha", "mhd"])
def test_an_image_in_all_48_orientations(tmp_path, suffix):
    path = tmp_path / f"a.{suffix}"
    for order, signs in TURNS:
        voxels = np.flip(BLOCK.transpose(order), axis=[k for k in range(3) if signs[k] < 0])
        voxels = np.ascontiguousarray(voxels)
        steps = np.zeros((3, 3))
        first = np.full(3, 0.5)
        for axis, (towards, sign) in enumerate(zip(order, signs, strict=True)):
            steps[axis, towards] = sign
            if sign < 0:
                first[towards] = BLOCK.shape[towards] - 0.5
        if suffix.startswith("nii"):
            write_nifti(path, voxels, np.column_stack([steps.T, first]))
        elif suffix.startswith("m"):
            write_metaimage(path, voxels, steps, first, is_packed=suffix == "mhd")
        else:
            header = {"space dimension": 3, "space directions": steps, "space origin": first}
            nrrd.write(str(path), voxels, header | {"space units": ["mm"] * 3}, index_order="F")
        reading = read_file(path)
        assert reading.unit == ("" if suffix.startswith("m") else "mm")
        check_block(reading)


@pytest.mark.parametrize("code", [(1, 1e-3), (2, 1.0), (3, 1e3)])
def test_the_unit_of_nifti_is_converted(tmp_path, code):
    size = code[1]
    affine = np.column_stack([size * np.eye(3), np.full(3, 0.5 * size)])
    write_nifti(tmp_path / "a.nii", BLOCK, affine, unit=code[0])
    check_block(read_file(tmp_path / "a.nii", lengths=Lengths(convert_to="mm")))


def test_images_of_boxes_and_of_other_formats(tmp_path):
    thick = BLOCK[:, :, ::3].copy()  # The block is 2 voxels thick, and each of them 3 mm.
    assert thick.sum() == 4 * 8 * 2
    affine = np.column_stack([np.diag([1.0, 1, 3]), [0.5, 0.5, 1.5]])
    write_nifti(tmp_path / "a.nii.gz", thick, affine)
    check_block(read_file(tmp_path / "a.nii.gz"))
    np.save(tmp_path / "a.npy", BLOCK)
    check_block(read_file(tmp_path / "a.npy"))
    pages = BLOCK.transpose(2, 1, 0)
    tifffile.imwrite(tmp_path / "a.tif", pages, photometric="minisblack", compression="lzw")
    check_block(read_file(tmp_path / "a.tif"))
    image = pyvista.ImageData(dimensions=np.array(BLOCK.shape) + 1)
    image.cell_data["a"] = BLOCK.ravel(order="F")
    image.save(tmp_path / "a.vti")
    check_block(read_file(tmp_path / "a.vti"))
    layer = Pillow.fromarray(255 * BLOCK[:, ::-1, 5].T)
    layer.save(tmp_path / "a.png")
    lengths = Lengths(unit="mm")
    picture = read_file(tmp_path / "a.png", lengths=lengths, image={"voxel_size": 1.0}).geometry
    assert np.array_equal(picture.fractions(), BLOCK[:, :, 5])
    assert (picture.bounding_box(), picture.unit) == (((0.0, 0.0), (6.0, 11.0)), "mm")


def write_series(folder, *, without=(), shift=0.0):
    """Write the block as a series of slices with names that are not in order."""
    folder.mkdir()
    for k in range(BLOCK.shape[2]):
        if k not in without:
            first = (0.5, 0.5, 0.5 + k + (shift if k == 7 else 0.0))
            write_dicom(folder / f"{k * 7 % 10}.dcm", BLOCK[:, :, k].T, first=first)
    return folder / "0.dcm"


def test_a_dicom_series_is_read_whole_by_any_of_its_files(tmp_path):
    path = write_series(tmp_path / "a")
    reading = read_file(path)
    assert reading.unit == "mm"
    check_block(reading)
    check_block(read_file(path.with_name("4.dcm")))


def test_a_dicom_series_with_missing_slices_says_where(tmp_path):
    with pytest.raises(GeometryError) as caught:
        read_file(write_series(tmp_path / "a", without=(4, 5)))
    assert caught.value.found == (
        "about 2 slices are missing between 3.5 and 6.5 mm: the others are 1 mm apart"
    )
    with pytest.raises(GeometryError, match=r"unevenly spaced between 6\.5 and 7\.7 mm"):
        read_file(write_series(tmp_path / "b", shift=0.2))
    with pytest.raises(GeometryError, match="2 slices lie at the same place"):
        read_file(write_series(tmp_path / "c", shift=1.0))
    with pytest.raises(GeometryError, match="the series has one slice"):
        read_file(write_series(tmp_path / "d", without=range(1, 10)))


# Outlines: a plate with a hole, in millimetres.
RING = np.array([[1.0, 2], [5, 2], [5, 9], [1, 9], [1, 2]])
HOLE = np.array([[2.0, 4], [2, 6], [4, 6], [4, 4], [2, 4]])


def write_outlines(folder):
    """Write the plate in every format of outlines."""
    shape = shapely.Polygon(RING, [HOLE])
    (folder / "a.geojson").write_text(json.dumps(shapely.geometry.mapping(shape)))
    (folder / "a.wkt").write_text(shape.wkt)
    write_geopackage(folder / "a.gpkg", [shape])
    write_gml(folder / "a.gml", [RING, HOLE])
    # Two arcs make the ring, the second one backwards; numbers are differences of tenths.
    arcs = [RING[:3], RING[2:][::-1], HOLE]
    packed = [np.rint(np.diff(10 * a, axis=0, prepend=0)).astype(int).tolist() for a in arcs]
    item = {"type": "Polygon", "arcs": [[0, -2], [2]]}
    document = {"type": "Topology", "objects": {"a": item}, "arcs": packed}
    document["transform"] = {"scale": [0.1, 0.1], "translate": [0, 0]}
    (folder / "a.topojson").write_text(json.dumps(document))
    with shapefile.Writer(str(folder / "a"), shapeType=shapefile.POLYGON) as writer:
        writer.field("n", "N")
        writer.poly([RING[::-1].tolist(), HOLE[::-1].tolist()])
        writer.record(1)
    drawing = ezdxf.new("R2000")
    drawing.header["$INSUNITS"] = 4
    for ring in (RING, HOLE):
        drawing.modelspace().add_lwpolyline(ring[:-1].tolist(), close=True)
    drawing.saveas(folder / "a.dxf")
    chains = [" L ".join(f"{x} {-y}" for x, y in ring[:-1]) for ring in (RING, HOLE)]
    (folder / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="10mm" height="10mm" viewBox="0 -10 10 10">'
        f'<path fill-rule="evenodd" d="M {chains[0]} Z M {chains[1]} Z"/></svg>'
    )
    rows = [f"{a[0]},{a[1]},{b[0]},{b[1]}" for r in (RING, HOLE) for a, b in itertools.pairwise(r)]
    (folder / "a.csv").write_text("\n".join(["x0,y0,x1,y1", *rows]) + "\n")


OUTLINES = ("geojson", "wkt", "gpkg", "gml", "topojson", "shp", "dxf", "svg", "csv")


def test_an_outline_in_every_format_has_one_mesh(tmp_path):
    write_outlines(tmp_path)
    meshes = {}
    for suffix in OUTLINES:
        path = tmp_path / f"a.{suffix}"
        result = tusqh.mesh(path, unit="mm", convert_to="m", cells=14, placement="corner")
        meshes[suffix] = result.mesh
        assert result.mesh.measurement.volume == pytest.approx(24e-6), suffix
    for suffix, mesh in meshes.items():
        assert np.array_equal(mesh.cells, meshes["csv"].cells), suffix
        assert mesh.points == pytest.approx(meshes["csv"].points, abs=1e-12), suffix


def test_kml_is_projected_and_a_geopackage_states_its_system(tmp_path):
    degrees = shapely.Polygon(np.array([[-76.5, 38.9], [-76.49, 38.9], [-76.49, 38.91]]))
    ring = " ".join(f"{x},{y}" for x, y in degrees.exterior.coords)
    (tmp_path / "a.kml").write_text(
        f"<kml><Placemark><Polygon><outerBoundaryIs><LinearRing><coordinates>{ring}"
        "</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></kml>"
    )
    write_geopackage(tmp_path / "a.gpkg", [degrees], srs=(4326, "EPSG", 4326, "undefined"))
    (tmp_path / "a.wkt").write_text(f"SRID=4326;{degrees.wkt}")
    corners = np.array(degrees.exterior.coords)
    write_gml(tmp_path / "a.gml", [corners], system="EPSG:4326", is_old=True)
    # In a URN the order is that of the authority: latitude first.
    urn = "urn:ogc:def:crs:EPSG::4326"
    write_gml(tmp_path / "b.gml", [corners[:, ::-1]], system=urn)
    boxes = []
    for name in ("a.kml", "a.gpkg", "a.wkt", "a.gml", "b.gml"):
        with pytest.raises(GeometryError, match="longitudes and latitudes"):
            read_file(tmp_path / name)
        reading = read_file(tmp_path / name, lengths=Lengths(crs="utm"))
        assert reading.unit == "m"
        boxes.append(reading.geometry.bounding_box())
    assert all(box == boxes[0] for box in boxes)


def test_gml_with_curves_or_several_systems_is_refused(tmp_path):
    write_gml(tmp_path / "a.gml", [RING], system="EPSG:32618")
    text = (tmp_path / "a.gml").read_text()
    (tmp_path / "b.gml").write_text(text.replace("LinearRing", "Arc").replace("Polygon", "Curve"))
    with pytest.raises(GeometryError, match="an element <Arc>"):
        read_file(tmp_path / "b.gml")
    other = text.replace("<gml:exterior", '<gml:exterior srsName="EPSG:32619"', 1)
    (tmp_path / "c.gml").write_text(other)
    with pytest.raises(GeometryError, match="the coordinate systems EPSG:32618, EPSG:32619"):
        read_file(tmp_path / "c.gml")
    (tmp_path / "d.gml").write_text(text.replace("1.0", "one"))
    with pytest.raises(GeometryError, match="the coordinates of geometry 0 cannot be read"):
        read_file(tmp_path / "d.gml")


def write_surface(path):
    """Write the box as a surface in the format of the suffix; return the unit to give."""
    unit = "m" if path.suffix in (".glb", ".gltf") else "mm"
    points, triangles = box_in(unit)
    mesh = trimesh.Trimesh(points, triangles, process=False)
    if path.suffix == ".3mf":
        write_threemf(path, points, triangles)
    elif path.suffix in (".step", ".stp"):
        path.write_text(step_box(tuple(1e3 * LOW), tuple(1e3 * HIGH), unit="mm"))
    elif path.suffix in (".vtk", ".vtp", ".vtu"):
        faces = np.column_stack([np.full(len(triangles), 3), triangles]).ravel()
        surface = pyvista.PolyData(points, faces=faces)
        (surface.cast_to_unstructured_grid() if path.suffix == ".vtu" else surface).save(path)
    elif path.suffix == ".gltf":
        for name, content in trimesh.exchange.gltf.export_gltf(trimesh.Scene([mesh])).items():
            (path if name.endswith(".gltf") else path.with_name(name)).write_bytes(content)
    else:
        mesh.export(path)
    return None if path.suffix in (".glb", ".gltf", ".3mf", ".step", ".stp") else "mm"


def write_image(path):
    """Write the block as an image, or a layer of it as a picture; return the options to give."""
    steps, first = np.eye(3), np.full(3, 0.5)
    if path.name.endswith((".nii", ".nii.gz")):
        write_nifti(path, BLOCK, np.column_stack([steps, first]))
    elif path.suffix in (".mha", ".mhd"):
        write_metaimage(path, BLOCK, steps, first)
    elif path.suffix in (".nrrd", ".nhdr"):
        nrrd.write(str(path), BLOCK, {"space directions": steps, "space origin": first})
    elif path.suffix == ".vti":
        image = pyvista.ImageData(dimensions=np.array(BLOCK.shape) + 1)
        image.cell_data["a"] = BLOCK.ravel(order="F")
        image.save(path)
    elif path.suffix == ".npy":
        np.save(path, BLOCK)
    elif path.suffix in (".tif", ".tiff"):
        tifffile.imwrite(path, BLOCK.transpose(2, 1, 0), photometric="minisblack")
    elif path.suffix == ".dcm":
        write_dicom(path, BLOCK.transpose(2, 1, 0))
    elif path.suffix == ".spn":
        path.write_text("\n".join(map(str, BLOCK.ravel().tolist())) + "\n")
        return {"voxels": list(BLOCK.shape)}
    else:
        Pillow.fromarray(255 * BLOCK[:, ::-1, 5].T).save(path, **JPEG.get(path.suffix, {}))
    return {}


JPEG = {suffix: {"quality": 100, "subsampling": 0} for suffix in (".jpg", ".jpeg")}


#: KML has longitudes and latitudes only, and IGES here surfaces only; tests above have them.
ELSEWHERE = {".kml", ".iges", ".igs"}


@pytest.mark.parametrize("suffix", [s for s in suffixes_of() if s not in ELSEWHERE])
def test_every_suffix_of_the_table_has_the_solid_in_its_place_in_metres(tmp_path, suffix):
    path, image, unit = tmp_path / f"a{suffix}", None, None
    kind = find_format(str(path)).kind
    low, high = 1e3 * LOW, 1e3 * HIGH
    if kind == "outline":
        write_outlines(tmp_path)
        unit = "mm"
        low, high = low[:2], high[:2] - [0, 1]
        if suffix == ".json":
            path.write_text(path.with_suffix(".geojson").read_text())
    elif kind == "surface":
        unit = write_surface(path)
    else:
        image = write_image(path)
    if kind in ("image", "picture") and suffix not in (".dcm", ".nii", ".nii.gz"):
        unit = "mm"
    reading = read_file(path, image=image, lengths=Lengths(unit=unit, convert_to="m"))
    geometry = reading.geometry
    assert reading.unit == "m"
    if kind in ("image", "picture"):
        there = np.argwhere(geometry.fractions() > 0.5)
        box = geometry.origin + geometry.voxel_size * np.stack([there, there + 1])
        low, high = low[: geometry.dim], high[: geometry.dim]
        found = box.min(axis=(0, 1)), box.max(axis=(0, 1))
        assert len(there) == (BLOCK if kind == "image" else BLOCK[:, :, 5]).sum()
    else:
        found = geometry.bounding_box()
    assert 1e3 * np.array(found) == pytest.approx(np.array([low, high]), abs=1e-5)


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("a.sldprt", "save it as STEP"),
        ("a.dwg", "save it as DXF"),
        ("a.fgb", "ogr2ogr"),
        ("a.fbx", "glTF"),
        ("a.bmp", "PNG"),
        ("a.mgz", "NIfTI"),
        ("IM0001", "rename all files to .dcm"),
    ],
)
def test_what_is_not_read_says_what_to_convert_it_to(tmp_path, name, remedy):
    (tmp_path / name).write_bytes(b"anything")
    with pytest.raises(GeometryError) as caught:
        read_file(tmp_path / name)
    assert remedy in caught.value.remedy
