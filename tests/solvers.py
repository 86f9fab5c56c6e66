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
