"""Peers on the systems that errorTime.edp exported: GetFEM's nodal contact Newton (MUMPS) on the whole system,
Siconos' Newton method on the condensed one. Each run is stopped after ever more iterations, so that error against run
time shows: CPU time on one thread, and wall time on all cores; errors are in the energy norm, against the exported
reference. A peer that is not installed is a labelled gap. Usage: peers.py systems.txt peers.csv"""
import ctypes
import sys
import time

import numpy as np
import scipy.sparse as sp


def read(name):
    with open(name, "rb") as f:
        def array(kind):
            size = np.fromfile(f, np.int64, 1)[0]
            return np.fromfile(f, kind, size)
        d, n, m = array(np.int32)
        outer, inner, value = array(np.int32), array(np.int32), array(np.float64)
        A = sp.csr_matrix((value, inner, outer), shape=(n, n))
        F, first, gap, mu, x = (array(k) for k in (np.float64, np.int32, np.float64, np.float64, np.float64))
        nc = n - first[0]
        S, f_c = array(np.float64).reshape(nc, nc), array(np.float64)
    return dict(d=int(d), n=int(n), m=int(m), A=A, F=F, first=first, gap=gap, mu=mu, x=x, S=S, f=f_c)


def both_times(solve):
    """CPU seconds of solve() on one thread, wall seconds on all cores; and its answer. MUMPS has no threads of its own."""
    openblas = ctypes.CDLL("libopenblas.so.0")
    openblas.openblas_set_num_threads(1)
    start = time.process_time()
    answer = solve()
    seconds = time.process_time() - start
    openblas.openblas_set_num_threads(openblas.openblas_get_num_procs())
    start = time.perf_counter()
    solve()
    return seconds, time.perf_counter() - start, answer


def matrix_market(C):
    from scipy.io import mmwrite
    mmwrite("peer_matrix.mtx", C)
    return "peer_matrix.mtx"


def error(s, x):
    e = x - s["x"]
    return np.sqrt(max(e @ (s["A"] @ e), 0) / (s["x"] @ (s["A"] @ s["x"])))


def getfem_runs(s):
    import getfem as gf
    n, m, d, mu = s["n"], s["m"], s["d"], s["mu"].max()
    normal, size = s["first"][:m], np.diff(s["first"])
    stiffness = s["A"].diagonal()[normal].mean()
    # its friction wants d - 1 tangents at every node: idle dofs where Dirichlet conditions hold them
    tangent, idle = [], 0
    for i in range(m):
        for k in range(1, d):
            if k < size[i]:
                tangent.append(normal[i] + k)
            else:
                tangent.append(n + idle)
                idle += 1
    if mu == 0:
        idle = 0
    C = sp.block_diag([s["A"], stiffness * sp.identity(idle)]).tocsc() if idle else s["A"].tocsc()
    F = np.concatenate([s["F"], np.zeros(idle)])
    K = gf.Spmat("load", "mm", matrix_market(C))
    for r in (stiffness / 10, stiffness):
        if n > 14000 and r == stiffness:
            continue  # the better of the two takes minutes there
        for steps in 2, 4, 6, 10, 25:
            def solve():
                BN, BT = gf.Spmat("empty", m, n + idle), gf.Spmat("empty", m * (d - 1), n + idle)
                for i in range(m):
                    BN.add(i, int(normal[i]), 1.0)
                for i in range(m * (d - 1) if mu > 0 else 0):
                    BT.add(i, int(tangent[i]), 1.0)
                model = gf.Model("real")
                model.add_variable("u", n + idle)
                model.add_explicit_matrix("u", "u", K, 1, 1)
                model.add_explicit_rhs("u", F)
                model.add_initialized_data("r", [r])
                model.add_variable("lambda_n", m)
                model.add_initialized_data("gap", s["gap"])
                model.add_initialized_data("alpha", np.ones(m))
                laws = ["u", "lambda_n", "r", BN, "gap", "alpha", 1]
                if mu > 0:
                    model.add_variable("lambda_t", m * (d - 1))
                    model.add_initialized_data("friction", [mu])
                    laws = ["u", "lambda_n", "lambda_t", "r", BN, BT, "friction", "gap", "alpha", 1]
                model.add_basic_contact_brick(*laws)
                model.solve("max_res", 1e-10 * np.linalg.norm(F), "max_iter", steps, "lsolver", "mumps")
                return model.variable("u")[:n]
            cpu, wall, u = both_times(solve)
            e = error(s, u)
            yield "GetFEM", f"nodal Newton; r = {r / stiffness:g} diag A", cpu, wall, steps, e
            if e < 1e-11:
                break


def siconos_runs(s, condensation):
    import siconos.numerics as sn
    m, d, first = s["m"], s["d"], s["first"] - s["first"][0]
    x_ref = s["x"][s["first"][0]:]
    r_ref = s["f"] - s["S"] @ x_ref
    # the Delassus matrix is the inverse of S, which a body held by contact alone does not have: one node without
    # tangents that is known to press is held
    held = [first[i] for i in range(m) if first[i + 1] - first[i] == 1 and r_ref[first[i]] > 0]
    if not held:
        raise RuntimeError("S is singular, there is no Delassus matrix")
    h = held[0]
    rest = np.delete(np.arange(len(x_ref)), h)
    S, f = s["S"][np.ix_(rest, rest)], s["f"][rest] - s["S"][rest, h] * x_ref[h]
    # y = (gap - x_N, -x_T) = W r + q, r the force of the body on the obstacle; three components a node, the missing
    # ones idle
    index = np.array([3 * i + k for i in range(m) for k in range(first[i + 1] - first[i]) if first[i] + k != h])
    C = np.linalg.inv(S)
    for steps in 1, 2, 3, 5, 7, 10, 15, 20, 50, 100:
        def solve():
            C = np.linalg.inv(S)
            W = np.zeros((3 * m, 3 * m))
            W[np.ix_(index, index)] = C
            idle = np.setdiff1d(np.arange(3 * m), index)
            W[idle, idle] = C.diagonal().mean()
            q = np.zeros(3 * m)
            q[index] = -C @ f
            q[3 * np.arange(m)] += s["gap"]
            length = np.linalg.norm(q)  # its tolerances are absolute: unknowns of order one
            force = length / np.abs(C).max()
            problem = sn.FrictionContactProblem(3, m, W * (force / length), q / length, s["mu"])
            options = sn.SolverOptions(sn.SICONOS_FRICTION_3D_NSN_AC)
            options.iparam[sn.SICONOS_IPARAM_MAX_ITER] = steps
            options.dparam[sn.SICONOS_DPARAM_TOL] = 1e-14
            r, y = np.zeros(3 * m), np.zeros(3 * m)
            sn.fc3d_driver(problem, r, y, options)
            return r[index] * force
        cpu, wall, r = both_times(solve)
        # the interior follows from x_C without further error: |e|_A = |e_C|_S
        e = C @ (f - r) - x_ref[rest]
        yield "Siconos", "NSN_AC on the condensed system", cpu + condensation, wall + condensation, steps, \
            np.sqrt(max(e @ (S @ e), 0) / (s["x"] @ (s["A"] @ s["x"])))


def main(systems, output):
    with open(output, "w") as out:
        out.write("scene,method,variant,units,wall,iterations,error\n")
        for line in open(systems):
            name, unit, condensation = line.split()
            s = read(f"system_{name}.bin")
            for peer, runs in (("GetFEM", lambda: getfem_runs(s)),
                               ("Siconos", lambda: siconos_runs(s, float(condensation)))):
                try:
                    for method, variant, cpu, wall, steps, e in runs():
                        out.write(f"{name},{method},{variant},{cpu / float(unit)},{wall / float(unit)},{steps},{e}\n")
                except ImportError as missing:
                    print(f"{peer} is not installed ({missing}): left out")
                except Exception as failure:  # a peer's failure is a result, too
                    print(f"{peer} on {name}: {failure}")
                    out.write(f"{name},{peer},failed,,,,\n")
                out.flush()


main(*sys.argv[1:])
