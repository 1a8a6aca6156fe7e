"""GetFEM's contact of two elastic bodies on the meshes of NAFEMS CB1 that roller.edp wrote: CPU time from the meshes to
the field, and errors of p0 and a as there; added to roller.csv. Usage: rollerPeer.py roller.csv

Two of its bricks: the nodal one between non-matching meshes, and the integral one for large sliding, by raytracing, in the
deformed configuration: its limits are not those of Hertz' small strains, about 0.7 % off. The third, integral contact
between non-matching meshes, takes a pair of points up to a gap of 5 % of an element only (projected_fem), which a roller
leaves at once: it ends with the load on one element, which is counted here as such.

The roller hangs on contact alone, without which the first Newton step is singular: it starts pressed in by 0.3 mm."""
import csv
import sys
import time

import numpy as np

RADIUS, LOAD, NU, E1, E2 = 50.0, 17500.0, 0.3, 210000.0, 70000.0
STAR = 1 / ((1 - NU**2) * (1 / E1 + 1 / E2))
HALF_WIDTH = np.sqrt(8 * LOAD * RADIUS / (np.pi * STAR))
PEAK = 4 * LOAD / (np.pi * HALF_WIDTH)
PRESSED = 0.3
CONTACT, AXIS, BOTTOM = 1, 2, 3  # labels
BRICKS = {"GetFEM nodal": 1.0, "GetFEM raytracing": 1.0, "GetFEM integral": 0.1}  # r: times E2, or E2/h


def read(name):
    """Vertices, triangles and labelled edges of a mesh that FreeFEM saved."""
    with open(name) as f:
        counts = [int(k) for k in f.readline().split()]
        lines = [f.readline().split() for _ in range(sum(counts))]
    vertices, triangles, edges = (lines[sum(counts[:k]):sum(counts[:k + 1])] for k in range(3))
    return (np.array([[float(c) for c in v[:2]] for v in vertices]), np.array(triangles, int)[:, :3] - 1,
            [(int(i) - 1, int(j) - 1, int(label)) for i, j, label in edges])


def load_mesh(gf, X, T, edges):
    mesh = gf.Mesh("pt2D", X.T, T.T)
    face = {}
    for c, f in mesh.outer_faces().T:
        face[tuple(sorted(np.ravel(mesh.pid_in_faces(np.array([[c], [f]])))))] = (c, f)
    for label in (CONTACT, AXIS, BOTTOM):
        found = [face[tuple(sorted((i, j)))] for i, j, l in edges if l == label]
        mesh.set_region(label, np.array(found).T)
    return mesh


def finite_elements(gf, mesh, order, components):
    fem = gf.MeshFem(mesh, components)
    fem.set_fem(gf.Fem(f"FEM_PK(2,{order})"))
    return fem


def elastic(gf, md, k, mesh, fem, young):
    im = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(6)"))
    md.add_fem_variable(f"u{k}", fem)
    md.add_initialized_data(f"lambda{k}", young * NU / ((1 + NU) * (1 - 2 * NU)))
    md.add_initialized_data(f"mu{k}", young / (2 * (1 + NU)))
    md.add_isotropic_linearized_elasticity_brick(im, f"u{k}", f"lambda{k}", f"mu{k}")
    md.add_generalized_Dirichlet_condition_with_penalization(im, f"u{k}", 1e6 * E2, AXIS, "zero", "along_x")
    return im


def solve(gf, brick, cells, order):
    """CPU seconds, dofs, and the forces on the hats of the slave's vertices as {position: force}."""
    (X1, T1, edges1), (X2, T2, edges2) = read(f"roller_{cells}.msh"), read(f"roller_block_{cells}.msh")
    m1, m2 = load_mesh(gf, X1, T1, edges1), load_mesh(gf, X2, T2, edges2)
    start = time.process_time()
    u1, u2 = finite_elements(gf, m1, order, 2), finite_elements(gf, m2, order, 2)
    md = gf.Model("real")
    for name, value in (("zero", [0.0, 0.0]), ("along_x", [[1.0, 0.0], [0.0, 0.0]]), ("along_y", [[0.0, 0.0], [0.0, 1.0]])):
        md.add_initialized_data(name, value)
    i1, i2 = elastic(gf, md, 1, m1, u1, E1), elastic(gf, md, 2, m2, u2, E2)
    md.add_generalized_Dirichlet_condition_with_penalization(i2, "u2", 1e6 * E2, BOTTOM, "zero", "along_y")
    at = u1.basic_dof_nodes()
    pressed = np.zeros(u1.nbdof())
    pressed[1::2] = -PRESSED
    md.set_variable("u1", pressed)
    load = np.zeros(u1.nbdof())
    load[np.flatnonzero(np.hypot(at[0], at[1] - 2 * RADIUS) < 1e-9).max()] = -LOAD
    md.add_explicit_rhs("u1", load)
    r = BRICKS[brick] * E2 * (1 if "nodal" in brick else cells / HALF_WIDTH)
    md.add_initialized_data("r", [r])
    if "nodal" in brick:
        md.add_nodal_contact_between_nonmatching_meshes_brick(i1, i2, "u1", "u2", "lambda", "r", CONTACT, CONTACT)
    else:
        hats = finite_elements(gf, m1, 1, 2 if "raytracing" in brick else 1)
        md.add_filtered_fem_variable("lambda", hats, CONTACT)
    if "integral" in brick:
        md.add_integral_contact_between_nonmatching_meshes_brick(i1, "u1", "u2", "lambda", "r", CONTACT, CONTACT, 1)
    if "raytracing" in brick:
        contact = md.add_integral_large_sliding_contact_brick_raytracing("r", 5.0)
        md.add_slave_contact_boundary_to_large_sliding_contact_brick(contact, i1, CONTACT, "u1", "lambda")
        md.add_master_contact_boundary_to_large_sliding_contact_brick(contact, i2, CONTACT, "u2")
    steps, converged = md.solve("max_res", 1e-9 * LOAD, "max_iter", 30, "lsolver", "mumps")
    seconds = time.process_time() - start
    if not converged:
        raise RuntimeError(f"not converged in {steps} steps")
    multiplier = md.variable("lambda")
    if "nodal" in brick:
        on = u1.basic_dof_on_region(CONTACT)[::2]
        forces = {key(at[:, k]): -value for k, value in zip(on, multiplier)}
    else:
        full = np.zeros(hats.nbdof())
        full[hats.basic_dof_on_region(CONTACT)] = multiplier
        if "integral" in brick:
            forces = gf.asm_boundary(CONTACT, "a=data(#1);V(#1)+=comp(Base(#1).Base(#1))(:,j).a(j)", i1, hats, -full)
            forces = {key(x): f for x, f in zip(hats.basic_dof_nodes().T, forces)}
        else:
            forces = gf.asm_boundary(CONTACT, "a=data(#1);V(#1)+=comp(vBase(#1).vBase(#1))(:,i,j,i).a(j)", i1, hats, full)
            forces = {key(x): f for x, f in zip(hats.basic_dof_nodes().T[::2], forces[1::2])}
    return seconds, u1.nbdof() + u2.nbdof(), on_vertices(X1, edges1, forces)


def key(x):
    return tuple(np.round(x, 7))


def on_vertices(X, edges, forces):
    """Position along x, room and force of each vertex of the slave; a middle gives half of its force to either end."""
    found = {}
    for i, j, label in edges:
        if label != CONTACT:
            continue
        half, middle = abs(X[i, 0] - X[j, 0]) / 2, forces.get(key((X[i] + X[j]) / 2), 0) / 2
        for k in (i, j):
            x, room, force = found.get(k, (X[k, 0], 0, forces.get(key(X[k]), 0)))
            found[k] = (x, room + half, force + middle)
    return np.array(sorted(found.values()))


def errors(vertices):
    """Of p0 and a in per cent, by least squares of p^2 = p0^2 (1 - x^2/a^2) where p > 0.2 p0, without the axis."""
    p = vertices[:, 2] / vertices[:, 1]
    use = p > 0.2 * PEAK
    use[0] = False
    if use.sum() < 2:
        raise RuntimeError("the load is carried by one element")
    constant, slope = np.polynomial.polynomial.polyfit(vertices[use, 0] ** 2, p[use] ** 2, 1)
    if constant < 0 or slope > 0:
        raise RuntimeError("the pressure is not that of a roller")
    return 100 * (np.sqrt(constant) / PEAK - 1), 100 * (np.sqrt(-constant / slope) / HALF_WIDTH - 1)


def main(table):
    try:
        import getfem as gf
    except ImportError as missing:
        print(f"GetFEM is not installed ({missing}): left out of CB1")
        return
    gf.util("trace level", 0)
    rows = [r for r in csv.DictReader(open(table)) if r["method"] == "ours"]
    with open(table, "a") as out:
        for row in rows:
            for brick in BRICKS:
                cells, order = int(row["cells"]), int(row["order"])
                if "integral" in brick and cells > 8:
                    continue
                name = f"{brick}, P{order}, a/h = {cells}"
                try:
                    seconds, dofs, vertices = solve(gf, brick, cells, order)
                    e_p0, e_a = errors(vertices)
                except Exception as failure:  # a peer's failure is a result, too
                    print(f"CB1, {name}: {str(failure).splitlines()[0]}")
                    out.write(f"{brick},{order},{cells},,,,\n")
                    continue
                print(f"CB1, {name}: {dofs} dofs, {seconds:.3g} s, p0 {e_p0:.3g} % off, a {e_a:.3g} % off")
                out.write(f"{brick},{order},{cells},{dofs},{seconds},{e_p0},{e_a}\n")
                out.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])
