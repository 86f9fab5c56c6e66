"""Write boxes as STEP (AP 214), and a flat patch as IGES."""

from itertools import product

UNITS = {
    "mm": "(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))",
    "m": "(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.))",
    "in": "(CONVERSION_BASED_UNIT('INCH',#9002) LENGTH_UNIT() NAMED_UNIT(#9003))",
}


def step_box(low, high, *, unit="mm", is_empty=False):
    """Return the text of a STEP file with one solid box, or with none."""
    low, high = (tuple(map(float, corner)) for corner in (low, high))
    lines, numbers = [], iter(range(100, 9000))

    def add(text):
        number = next(numbers)
        lines.append(f"#{number}={text};")
        return f"#{number}"

    def real(x):
        text = f"{float(x):.15g}"
        return text if "." in text else text.replace("e", ".e") if "e" in text else text + "."

    def point(p):
        return add(f"CARTESIAN_POINT('',({','.join(map(real, p))}))")

    def direction(d):
        return add(f"DIRECTION('',({','.join(f'{x:.1f}' for x in d)}))")

    corners = list(product(*zip(low, high, strict=True)))
    at = {c: point(c) for c in corners}
    vertex = {c: add(f"VERTEX_POINT('',{at[c]})") for c in corners}
    edges = {}

    def edge(a, b):
        if (b, a) in edges:
            return edges[b, a], ".F."
        if (a, b) not in edges:
            d = [(y > x) - (y < x) for x, y in zip(a, b, strict=True)]
            vector = add(f"VECTOR('',{direction(d)},1.)")
            line = add(f"LINE('',{at[a]},{vector})")
            edges[a, b] = add(f"EDGE_CURVE('',{vertex[a]},{vertex[b]},{line},.T.)")
        return edges[a, b], ".T."

    faces = []
    for axis, end in product(range(3), (0, 1)):
        others = [k for k in range(3) if k != axis]
        ring = []
        for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)):
            c = [0.0, 0.0, 0.0]
            c[axis] = (low, high)[end][axis]
            c[others[0]], c[others[1]] = (low, high)[i][others[0]], (low, high)[j][others[1]]
            ring.append(tuple(c))
        # Counter-clockwise seen from outside.
        if (axis == 1) == bool(end):
            ring.reverse()
        uses = []
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
            name, sense = edge(a, b)
            uses.append(add(f"ORIENTED_EDGE('',*,*,{name},{sense})"))
        loop = add(f"EDGE_LOOP('',({','.join(uses)}))")
        bound = add(f"FACE_OUTER_BOUND('',{loop},.T.)")
        normal = [0.0, 0.0, 0.0]
        normal[axis] = 1.0 if end else -1.0
        along = [0.0, 0.0, 0.0]
        along[others[0]] = 1.0
        frame = add(f"AXIS2_PLACEMENT_3D('',{at[ring[0]]},{direction(normal)},{direction(along)})")
        plane = add(f"PLANE('',{frame})")
        faces.append(add(f"ADVANCED_FACE('',({bound}),{plane},.T.)"))
    shell = add(f"CLOSED_SHELL('',({','.join(faces)}))")
    solid = add(f"MANIFOLD_SOLID_BREP('box',{shell})")
    origin = add(
        f"AXIS2_PLACEMENT_3D('',{point((0, 0, 0))},{direction((0, 0, 1))},{direction((1, 0, 0))})"
    )
    items = origin if is_empty else f"{origin},{solid}"
    context = (
        "#9001=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#9004)) "
        "GLOBAL_UNIT_ASSIGNED_CONTEXT((#9000,#9005,#9006)) REPRESENTATION_CONTEXT('',''));"
    )
    shape = "SHAPE_REPRESENTATION" if is_empty else "ADVANCED_BREP_SHAPE_REPRESENTATION"
    lines += [
        f"#9000={UNITS[unit]};",
        context,
        "#9002=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#9007);",
        "#9003=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);",
        "#9004=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-06),#9000,'accuracy','');",
        "#9005=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));",
        "#9006=(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT());",
        "#9007=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));",
        f"#9010={shape}('',({items}),#9001);",
        "#9011=APPLICATION_CONTEXT('automotive design');",
        "#9012=APPLICATION_PROTOCOL_DEFINITION('','automotive_design',2000,#9011);",
        "#9013=PRODUCT_CONTEXT('',#9011,'mechanical');",
        "#9014=PRODUCT('box','box','',(#9013));",
        "#9015=PRODUCT_DEFINITION_FORMATION('','',#9014);",
        "#9016=PRODUCT_DEFINITION_CONTEXT('part definition',#9011,'design');",
        "#9017=PRODUCT_DEFINITION('design','',#9015,#9016);",
        "#9018=PRODUCT_DEFINITION_SHAPE('','',#9017);",
        "#9019=SHAPE_DEFINITION_REPRESENTATION(#9018,#9010);",
    ]
    head = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
    head += "FILE_NAME('box','2026-01-01T00:00:00',(''),(''),'','','');\n"
    head += "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
    return head + "\n".join(lines) + "\nENDSEC;\nEND-ISO-10303-21;\n"


def iges_patch(width, depth, *, unit="MM"):
    """Return the text of an IGES file with one flat B-spline surface (type 128) in z = 0."""
    flag = {"INCH": 1, "MM": 2, "M": 6}[unit]
    rows = [f"{'patch':<72}S{1:7d}"]
    names = "1H,,1H;,5Hpatch,5Hpatch,1H1,1H1,32,38,6,308,15,5Hpatch,"
    names += f"1.,{flag},{len(unit)}H{unit},1,0.01,15H20260101.000000,1E-06,10.,,,11,0;"
    chunks = [names[k : k + 72] for k in range(0, len(names), 72)]
    rows += [f"{chunk:<72}G{k:7d}" for k, chunk in enumerate(chunks, 1)]
    corners = [(x, y, 0.0) for y in (0.0, depth) for x in (0.0, width)]
    data = "128,1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.,"
    data += ",".join(f"{x:g}" + ("" if "." in f"{x:g}" else ".") for p in corners for x in p)
    data += ",0.,1.,0.,1.;"
    parts, line = [], ""
    for word in data.replace(",", ",\n").split("\n"):
        if len(line) + len(word) > 64:
            parts.append(line)
            line = ""
        line += word
    parts.append(line)
    n = len(parts)
    rows.append(f"{128:8d}{1:8d}{0:8d}{0:8d}{0:8d}{0:8d}{0:8d}{0:8d}{'00000000':>8}D{1:7d}")
    rows.append(f"{128:8d}{0:8d}{0:8d}{n:8d}{0:8d}{'':8}{'':8}{'':8}{0:8d}D{2:7d}")
    rows += [f"{part:<64}{1:8d}P{k:7d}" for k, part in enumerate(parts, 1)]
    rows.append(f"S{1:7d}G{len(chunks):7d}D{2:7d}P{n:7d}{'':40}T{1:7d}")
    return "\n".join(rows) + "\n"
