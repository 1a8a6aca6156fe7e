"""GetFEM's large sliding, by raytracing, on the scene of examples/ironing2.edp: Newton steps, CPU time and forces.

Usage: ironingPeer.py disc.msh slab.msh along, the meshes as FreeFEM's savemesh writes them, along the increments that drag.
Its augmentation is r = E2/h; an increment that does not converge in 30 steps ends the run."""
import sys
import time

import getfem as gf
import numpy as np

from rollerPeer import read

MU, DEPTH, DRAG, PRESS, NU, E1, E2 = 0.3, 0.25, 2.5, 10, 0.3, 3.0, 1.0


def body(md, k, name, young, contact, held):
    X, T, edges = read(name)
    mesh = gf.Mesh("pt2D", X.T, T.T)
    face = {}
    for c, f in mesh.outer_faces().T:
        face[tuple(sorted(np.ravel(mesh.pid_in_faces(np.array([[c], [f]])))))] = (c, f)
    for region, label in ((1, contact), (2, held)):
        mesh.set_region(region, np.array([face[tuple(sorted((i, j)))] for i, j, l in edges if l == label]).T)
    fem, im = gf.MeshFem(mesh, 2), gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(4)"))
    fem.set_fem(gf.Fem("FEM_PK(2,1)"))
    G = young / (2 * (1 + NU))
    md.add_fem_variable(f"u{k}", fem)
    md.add_fem_data(f"w{k}", fem)
    md.add_initialized_data(f"G{k}", [G])
    md.add_initialized_data(f"L{k}", [2 * NU / (1 - 2 * NU) * G])
    J = f"Det(Id(2)+Grad_u{k})"
    md.add_nonlinear_term(im, f"G{k}/2*(Norm_sqr(Id(2)+Grad_u{k})-2)-G{k}*log({J})+L{k}/2*sqr(log({J}))")
    md.add_initialized_data(f"d{k}", [0.0, 0.0])
    md.add_Dirichlet_condition_with_simplification(f"u{k}", 2, f"d{k}")
    return fem, im


def run(disc, slab, along):
    md = gf.Model("real")
    (u1, i1), (u2, i2) = body(md, 1, disc, E1, 1, 2), body(md, 2, slab, E2, 3, 1)
    md.add_filtered_fem_variable("lambda", u1, 1)
    md.add_initialized_data("r", [6 * E2])
    md.add_initialized_data("mu", [MU])
    brick = md.add_integral_large_sliding_contact_brick_raytracing("r", 0.5, "mu")
    md.add_slave_contact_boundary_to_large_sliding_contact_brick(brick, i1, 1, "u1", "lambda", "w1")
    md.add_master_contact_boundary_to_large_sliding_contact_brick(brick, i2, 1, "u2", "w2")
    start, steps = time.process_time(), 0
    for k in range(1, PRESS + along + 1):
        before = [md.variable("u1"), md.variable("u2")]
        if k > 1:  # the straight line through the last two
            for i in (1, 2):
                md.set_variable(f"u{i}", 2 * before[i - 1] - md.variable(f"w{i}"))
        for i in (1, 2):
            md.set_variable(f"w{i}", before[i - 1])
        md.set_variable("d1", [DRAG * max(0, k - PRESS) / along, -DEPTH * min(1, k / PRESS)])
        few, converged = md.solve("max_res", 1e-10, "max_iter", 30, "lsolver", "mumps")
        steps += few
        if not converged:
            return f"fails in increment {k}, after {steps} steps"
    force = gf.asm_boundary(1, "a=data(#1);V(#1)+=comp(vBase(#1).vBase(#1))(:,i,j,i).a(j)", i1, u1, full(md, u1))
    return f"{steps} steps, {time.process_time() - start:.2f} s, force {-force[::2].sum():.4f} {-force[1::2].sum():.4f}"


def full(md, fem):
    values = np.zeros(fem.nbdof())
    values[fem.basic_dof_on_region(1)] = md.variable("lambda")
    return values


if __name__ == "__main__":
    gf.util("trace level", 0)
    print(sys.argv[3], "dragging increments:", run(sys.argv[1], sys.argv[2], int(sys.argv[3])))
