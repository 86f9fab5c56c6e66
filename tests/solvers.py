"""Heat and elasticity from mesh files and their named sets alone, by several programs.

Heat flows from the set `hole_1`, at 1, to the four outer sides, at 0; the conductivity is 1.  In
elasticity `x_min` is held along x and `x_max` is pulled by 100.
"""

import re
import shutil
import subprocess

import mfem.ser as mfem
import numpy as np
import skfem
from needs import require
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

OUTER = ("x_min", "x_max", "y_min", "y_max")
YOUNG, POISSON, PULL = 210e3, 0.3, 100.0


def heat_by_skfem(path, dim):
    """Return the heat flow from a file of Gmsh."""
    mesh = (skfem.MeshQuad if dim == 2 else skfem.MeshHex).load(path)
    basis = skfem.Basis(mesh, skfem.ElementQuad1() if dim == 2 else skfem.ElementHex1())
    matrix = skfem.BilinearForm(lambda u, v, _: (u.grad * v.grad).sum(axis=0)).assemble(basis)
    values = basis.zeros()
    hole = basis.get_dofs("hole_1").all()
    values[hole] = 1
    outer = np.concatenate([basis.get_dofs(name).all() for name in OUTER])
    fixed = np.union1d(hole, outer)
    values = skfem.solve(*skfem.condense(matrix, x=values, D=fixed))
    return float(values @ matrix @ values)


class MfemModel:
    """A mesh file of MFEM with the names in its comments."""

    def __init__(self, path):
        self.mesh = mfem.Mesh(str(path), 1, 1)
        self.dim = self.mesh.Dimension()
        self.order = 1 if self.mesh.GetNodes() is None else 2
        comments = re.findall(r"^# (\d+) (\w+): ", path.read_text(), re.MULTILINE)
        self.number = {name: int(number) for number, name in comments}
        self.collection = mfem.H1_FECollection(self.order, self.dim)

    def space(self, size=1):
        return mfem.FiniteElementSpace(self.mesh, self.collection, size)

    def marker(self, *names):
        found = mfem.intArray(self.mesh.bdr_attributes.Max())
        found.Assign(0)
        for name in names:
            found[self.number[name] - 1] = 1
        return found

    def fixed(self, space, *names, axis=-1):
        found = mfem.intArray()
        space.GetEssentialTrueDofs(self.marker(*names), found, axis)
        return np.array(list(found), dtype=int)


def matrix_of(form):
    form.Assemble()
    form.Finalize()
    sparse = form.SpMat()
    parts = sparse.GetDataArray(), sparse.GetJArray(), sparse.GetIArray()
    return csr_matrix(parts, shape=(sparse.Height(), sparse.Width())).copy()


def solve_with(matrix, right, values, fixed):
    free = np.setdiff1d(np.arange(len(values)), fixed)
    rest = right - matrix @ values
    values[free] += spsolve(matrix[free][:, free].tocsc(), rest[free])
    return values


def heat_by_mfem(path):
    """Return the heat flow from a file of MFEM."""
    model = MfemModel(path)
    space = model.space()
    form = mfem.BilinearForm(space)
    form.AddDomainIntegrator(mfem.DiffusionIntegrator())
    matrix = matrix_of(form)
    values = np.zeros(matrix.shape[0])
    hole = model.fixed(space, "hole_1")
    values[hole] = 1
    fixed = np.union1d(hole, model.fixed(space, *OUTER))
    values = solve_with(matrix, np.zeros(len(values)), values, fixed)
    return float(values @ matrix @ values)


def pull_by_mfem(path):
    """Return the mean of the stress along x at the Gauss points of every element.

    Also the largest mean over the corners of elements that meet at a point.
    """
    model = MfemModel(path)
    dim, space = model.dim, model.space(model.dim)
    shear = YOUNG / 2 / (1 + POISSON)
    second = YOUNG * POISSON / (1 + POISSON) / ((1 - POISSON) if dim == 2 else (1 - 2 * POISSON))
    moduli = mfem.ConstantCoefficient(second), mfem.ConstantCoefficient(shear)
    form = mfem.BilinearForm(space)
    form.AddDomainIntegrator(mfem.ElasticityIntegrator(*moduli))
    traction = mfem.Vector(dim)
    traction.Assign(0.0)
    traction[0] = PULL
    load, marker = mfem.VectorConstantCoefficient(traction), model.marker("x_max")
    right = mfem.LinearForm(space)
    right.AddBoundaryIntegrator(mfem.VectorBoundaryLFIntegrator(load), marker)
    right.Assemble()
    fixed = [model.fixed(space, "x_min", axis=0), [space.DofToVDof(0, 1)]]
    if dim == 3:
        fixed.append(model.fixed(space, "back", axis=2))
    matrix = matrix_of(form)
    values = np.zeros(matrix.shape[0])
    values = solve_with(matrix, right.GetDataArray().copy(), values, np.concatenate(fixed))
    shift = mfem.GridFunction(space)
    shift.GetDataArray()[:] = values

    def stress(element, at):
        transformation = model.mesh.GetElementTransformation(element)
        point = mfem.IntegrationPoint()
        (point.Set2 if dim == 2 else point.Set3)(*at)
        transformation.SetIntPoint(point)
        gradient = mfem.DenseMatrix()
        shift.GetVectorGradient(transformation, gradient)
        strain = np.diag(gradient.GetDataArray())
        return second * strain.sum() + 2 * shear * strain[0]

    line = np.polynomial.legendre.leggauss(model.order + 1)[0] / 2 + 0.5
    gauss = np.stack(np.meshgrid(*dim * [line]), axis=-1).reshape(-1, dim).tolist()
    elements = range(model.mesh.GetNE())
    means = np.array([np.mean([stress(k, at) for at in gauss]) for k in elements])
    corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    total = np.zeros((model.mesh.GetNV(), 2))
    if dim == 2:
        for k in elements:
            vertices = np.array(list(model.mesh.GetElementVertices(k)))
            total[vertices] += [[stress(k, at), 1] for at in corner.tolist()]
    return means, float((total[:, 0] / np.maximum(total[:, 1], 1)).max())


def run_calculix(folder, mesh, job):
    """Run a job of CalculiX on a mesh file in a folder; return its printed results."""
    if shutil.which("ccx") is None:
        require("ccx", "CalculiX is not installed")
    (folder / "job.inp").write_text(f"*INCLUDE, INPUT={mesh}\n{job}")
    done = subprocess.run(["ccx", "-i", "job"], cwd=folder, capture_output=True, text=True)
    assert "*ERROR" not in done.stdout, done.stdout
    return (folder / "job.dat").read_text()


def heat_by_calculix(folder, mesh, dim):
    """Return the heat flow from an input file."""
    fixed = "".join(f"{name}, 11, 11, 0.\n" for name in OUTER)
    job = f"""*MATERIAL, NAME=M
*CONDUCTIVITY
1.
*SOLID SECTION, ELSET=solid, MATERIAL=M
{"1." if dim == 2 else "**"}
*STEP
*HEAT TRANSFER, STEADY STATE
*BOUNDARY
{fixed}hole_1, 11, 11, 1.
*NODE PRINT, NSET=hole_1, TOTALS=ONLY
RFL
*END STEP
"""
    return float(run_calculix(folder, mesh, job).split()[-1])


def pull_by_calculix(folder, mesh, dim):
    """Return the same as `pull_by_mfem`."""
    held = "1, 2, 2\n" + ("back, 3, 3\n" if dim == 3 else "")
    flat = ", OUTPUT=2D" if dim == 2 else ""
    job = f"""*MATERIAL, NAME=M
*ELASTIC
{YOUNG}, {POISSON}
*SOLID SECTION, ELSET=solid, MATERIAL=M
{"1." if dim == 2 else "**"}
*STEP
*STATIC
*BOUNDARY
x_min, 1, 1
{held}*DSLOAD
x_max, P, {-PULL}
*EL PRINT, ELSET=solid
S
*EL FILE{flat}
S
*END STEP
"""
    printed = run_calculix(folder, mesh, job).splitlines()
    rows = np.array([line.split()[:3] for line in printed if len(line.split()) == 8], dtype=float)
    element = rows[:, 0].astype(int) - 1
    means = np.bincount(element, weights=rows[:, 2]) / np.bincount(element)
    block = (folder / "job.frd").read_text().partition(" -4  STRESS")[2].partition(" -3")[0]
    at_nodes = [float(line[13:25]) for line in block.splitlines() if line.startswith(" -1")]
    return means, max(at_nodes)


#: A job of getfem, run by the Python of the system: its package has no wheel.
_GETFEM = """
import sys
import numpy as np
import getfem
path, dim, hole, *outer = sys.argv[1:]
mesh = getfem.Mesh("import", "gmsh", path)
space = getfem.MeshFem(mesh, 1)
space.set_classical_fem(1)
model = getfem.Model("real")
model.add_fem_variable("u", space)
model.add_linear_term(getfem.MeshIm(mesh, 3), "Grad_u.Grad_Test_u")
for value, numbers in ((1.0, [hole]), (0.0, outer)):
    for number in numbers:
        data = f"value{number}"
        model.add_initialized_data(data, [value])
        model.add_Dirichlet_condition_with_simplification("u", int(number), data)
model.solve()
print(getfem.asm_generic(getfem.MeshIm(mesh, 3), 0, "Grad_u.Grad_u", -1, model))
"""


def heat_by_getfem(path, dim):
    """Return the heat flow from a file of Gmsh, by the numbers of its physical groups."""
    python = "/usr/bin/python3"
    found = subprocess.run([python, "-c", "import getfem"], capture_output=True)
    if found.returncode:
        require("getfem", "getfem is not installed (python3-getfem)")
    numbers = numbers_of_groups(path)
    given = [str(path), str(dim), *(numbers[name] for name in ("hole_1", *OUTER))]
    command = [python, "-c", _GETFEM, *given]
    environment = {"PATH": "/usr/bin:/bin", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    return float(done.stdout.split()[-1])


def numbers_of_groups(path):
    """Return the numbers of the physical groups in a file of Gmsh, by name."""
    names = path.read_text(errors="replace").partition("$PhysicalNames")[2].partition("$End")[0]
    return {name: number for number, name in re.findall(r'^\d+ (\d+) "(.*)"', names, re.MULTILINE)}


_HEADER = "FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n"
_SCHEMES = """ddtSchemes { default steadyState; } gradSchemes { default Gauss linear; }
divSchemes { default none; } laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; } snGradSchemes { default corrected; }"""
_SOLUTION = """solvers { T { solver PCG; preconditioner DIC; tolerance 1e-12; relTol 0; } }
SIMPLE { nNonOrthogonalCorrectors 3; }"""
_CONTROL = """application laplacianFoam; startFrom startTime; startTime 0;
stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; writeInterval 1;
writeFormat ascii; writePrecision 12;"""


def heat_by_openfoam(folder, mesh):
    """Return the heat flow from a file of Gmsh by finite volumes, whose patches have its names."""
    if shutil.which("laplacianFoam") is None:
        require("laplacianFoam", "OpenFOAM is not installed")
    files = {
        ("system", "controlDict", "dictionary"): _CONTROL,
        ("system", "fvSchemes", "dictionary"): _SCHEMES,
        ("system", "fvSolution", "dictionary"): _SOLUTION,
        ("constant", "transportProperties", "dictionary"): "DT 1;",
    }
    for (part, name, kind), text in files.items():
        _write_foam(folder, part, name, kind, text)
    environment = {"PATH": "/usr/bin:/bin", "WM_PROJECT_DIR": "/usr/share/openfoam"}
    environment["FOAM_ETC"] = "/usr/share/openfoam/etc"

    def call(*command):
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, (done.stdout + done.stderr)[-2000:]

    call("gmshToFoam", str(mesh))
    patches = '".*" { type zeroGradient; }\nhole_1 { type fixedValue; value uniform 1; }\n'
    patches += "".join(f"{n} {{ type fixedValue; value uniform 0; }}\n" for n in OUTER)
    text = f"dimensions [0 0 0 1 0 0 0]; internalField uniform 0;\nboundaryField {{ {patches} }}"
    _write_foam(folder, "0", "T", "volScalarField", text)
    call("laplacianFoam")
    return _flow_of(folder)


def _write_foam(folder, part, name, kind, text):
    (folder / part).mkdir(exist_ok=True)
    (folder / part / name).write_text(_HEADER.format(kind=kind, name=name) + text + "\n")


def _numbers_of(path, pattern):
    """Return the numbers in the lists of a file of OpenFOAM."""
    body = path.read_text().partition("(\n")[2]
    return [list(map(float, row.split())) for row in re.findall(pattern, body)]


def _list_of(path):
    """Return the first long list of numbers in a file of OpenFOAM."""
    return np.array(re.search(r"\n\d+\s*\(([^()]*)\)", path.read_text())[1].split(), dtype=float)


def _flow_of(folder):
    """Return the flow through the hole: (1 - T of the cell) * area / distance along the normal."""
    mesh = folder / "constant/polyMesh"
    points = np.array(_numbers_of(mesh / "points", r"\(([^()]+)\)"))
    faces = [np.array(row, dtype=int) for row in _numbers_of(mesh / "faces", r"\d+\(([^()]+)\)")]
    owner, neighbour = (_list_of(mesh / name).astype(int) for name in ("owner", "neighbour"))
    values = _list_of(folder / "1/T")
    block = re.search(r"hole_1\s*\{(.*?)\}", (mesh / "boundary").read_text(), re.DOTALL)[1]
    n, start = (int(re.search(rf"{key}\s+(\d+)", block)[1]) for key in ("nFaces", "startFace"))
    corners = [[] for _ in values]
    for k, face in enumerate(faces):
        corners[owner[k]] += face.tolist()
        if k < len(neighbour):
            corners[neighbour[k]] += face.tolist()
    flow = 0.0
    for face, cell in zip(faces[start : start + n], owner[start : start + n], strict=True):
        a, b, c, d = points[face]
        area = np.cross(c - a, d - b) / 2
        middle = points[np.unique(corners[cell])].mean(axis=0)
        distance = abs((points[face].mean(axis=0) - middle) @ area) / np.linalg.norm(area)
        flow += (1 - values[cell]) * np.linalg.norm(area) / distance
    return flow
