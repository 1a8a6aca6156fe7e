"""From the measured CSV files of the current folder: the pictures (gnuplot), report.md, and figures.txt, what README and
manual quote by name (tests/figures). Standard library only."""
import csv
import math
import os
import subprocess
from collections import defaultdict


def rows(name):
    if not os.path.exists(name):
        return []
    with open(name) as f:
        return list(csv.DictReader(f))


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return math.nan


def digits(text):
    """12 345"""
    return f"{int(text):,}".replace(",", " ")


def span(values, form=".2f"):
    low, high = (f"{v:{form}}" for v in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


error, stress, total, roller, multigrid = (rows(f"{n}.csv") for n in ("error", "stress", "total", "roller", "multigrid3d"))
peers = rows("peers.csv") + rows("ipopt.csv")
cost, pair = ([r for r in rows("cost.csv") if r["table"] == table] for table in ("cost", "pair"))
md, figures = [], []


def quote(name, text):
    """A figure that pages may quote."""
    figures.append(f"{name}\t{text}")
    return text


def table(name, header, lines, shown=True):
    """A table of the report, if shown, which pages may quote if it has a name."""
    lines = ["| " + " | ".join(header) + " |", "|---" * len(header) + "|"] + ["| " + " | ".join(line) + " |" for line in lines]
    md.extend(lines if shown else [])
    for line in lines if name else ():
        quote(name, line)


def plot(name, size, layout, panels):
    """panels: (commands, series), a series (title, style, points)"""
    text = (f"set terminal pngcairo size {size} font 'DejaVu Sans,11'; set output '{name}.png'\n"
            "set grid lc rgb '#dddddd'; set format xy '10^{%L}'; set tics nomirror; set logscale xy\n"
            f"set key font ',9' left top samplen 1; set multiplot layout {layout}\n")
    for commands, series in panels:
        shown = [(t, s, p) for t, s, p in ((t, s, [(x, y) for x, y in p if x > 0 and y > 0]) for t, s, p in series) if p]
        text += commands + "\nplot " + ", ".join(f"'-' with linespoints {s} title \"{t}\"" for t, s, _ in shown) + "\n"
        text += "".join("".join(f"{x} {y}\n" for x, y in p) + "e\n" for _, _, p in shown)
    with open(name + ".gp", "w") as f:
        f.write(text + "unset multiplot\n")
    subprocess.run(["gnuplot", name + ".gp"], check=True)
    md.append(f"\n![{name.replace('_', ' ')}]({name}.png)\n")


# --- error against run time -------------------------------------------------------------------------------------
METHODS = [("default", "", "default", "lc rgb '#c00000' pt 3 ps 2.5 lw 3"),
           ("multigrid", "", "multigrid", "lc rgb '#e060a0' pt 2 lw 2"),
           ("condensed", "", "condensed", "lc rgb '#803030' pt 1 ps 1.5 lw 2"),
           ("GC3", "hessian-ssor 1.5", "GC3", "lc rgb '#d06020' pt 7 lw 2"),
           ("GCX", "SSOR 1.5", "GCX", "lc rgb '#e0a000' pt 5 lw 2"),
           ("GC2", "hessian-ssor 1.5", "GC2", "lc rgb '#b08060' pt 9"),
           ("GC1", "hessian-ssor 1.5", "GC1", "lc rgb '#907050' pt 11"),
           ("SORP", "omega 1.8", "SORP", "lc rgb '#606060' pt 13"),
           ("GetFEM", "nodal Newton; r = 0.1 diag A", "GetFEM, nodal Newton, r = 0.1 diag A", "lc rgb '#2060c0' pt 4 lw 2"),
           ("GetFEM", "nodal Newton; r = 1 diag A", "GetFEM, nodal Newton, r = diag A", "lc rgb '#70a0e0' pt 6"),
           ("Siconos", "NSN_AC on the condensed system", "Siconos, NSN_AC on our S", "lc rgb '#208040' pt 8 lw 2"),
           ("ff-Ipopt", "epigraph in a fixed point", "ff-Ipopt, fixed point", "lc rgb '#8040a0' pt 10"),
           ("linear solve", "PCG SSOR", "linear solve: PCG SSOR", "lc rgb '#000000' dt 2 pt 1")]
QUOTED = {"block2d_n160_mu1": "block 160 x 160, mu = 1", "block3d_n16_mu0.3": "block 16^3, mu = 0.3",
          "dovetail_q36": "dovetail-like root", "hertz_c16": "Hertz, no friction"}
scenes = list(dict.fromkeys(r["scene"] for r in error))
quoted = [s for s in QUOTED if s in scenes] or [s for s in scenes if any(r["scene"] == s for r in peers)] or scenes[:4]


def runs(scene, method, variant, x="units"):
    """(cost, error) of a method's runs that ended well."""
    return [(number(r[x]), number(r["error"])) for r in error + peers if r["scene"] == scene and r["method"] == method
            and r["variant"] == variant and r.get("status", "converged") in ("converged", "regularized")]


def best(points):
    """The least error reached by each cost."""
    points = sorted(points)
    return [p for k, p in enumerate(points) if all(p[1] < q[1] for q in points[:k])]


def cost_to(scene, method, variant, reached, x="units"):
    return min((c for c, e in runs(scene, method, variant, x) if e <= reached), default=math.inf)


def cell(scene, method, variant, reached):
    if not any(r["scene"] == scene and r["method"] == method for r in error + peers):
        return ""
    cpu, wall = (cost_to(scene, method, variant, reached, x) for x in ("units", "wall"))
    return "-" if cpu == math.inf else f"{cpu:.2f}" + (f", {wall:.2f}" if wall < math.inf else "")


def least_error(method, variant):
    least = [min(e for _, e in runs(s, method, variant)) for s in scenes if runs(s, method, variant)]
    return span(least, ".0e") if least else ""


with open("/proc/cpuinfo") as f:
    model = next((line.split(":")[1].strip() for line in f if line.startswith("model name")), "")
cores = quote("cores", str(len(os.sched_getaffinity(0))))
md.append("# Measured: error against run time, stability, and what is left out\n")
md.append(f"Made by `make report` from its own runs alone, on {cores} cores of {model}. The unit of cost is one linear solve of "
          "the same matrix: CHOLMOD with AMD, with METIS, or FreeFEM's own as a script calls it, whichever takes the least CPU time, "
          "analyse + factor + solve. CPU times are on one thread, of the unit, of ours and of the peers; wall times are on all cores, "
          "in the same unit. Errors of fields: energy norm, relative.\n")
panels = []
for s in quoted:
    for x, label, place in (
            ("units", "CPU time on one thread", "lmargin at screen 0.06; set rmargin at screen 0.4; set key at graph 1.03, 0.5 left center Left reverse"),
            ("wall", f"wall time on {cores} cores", "lmargin at screen 0.65; set rmargin at screen 0.99; unset key")):
        panels.append((f"set title '{QUOTED.get(s, s.replace('_', ' '))}'; set xlabel '{label}, in units of one linear solve (grey line)'; "
                       "set arrow 1 from 1, graph 0 to 1, graph 1 nohead lw 2 lc rgb '#bbbbbb' back; set xrange [0.08:500]; "
                       f"set yrange [1e-15:2]; set ylabel 'error in the energy norm'; set {place}",
                       [(t.replace("_", "\\\\_"), style, best(runs(s, m, v, x))) for m, v, t, style in METHODS]))
plot("error_time", f"1600,{420 * len(quoted)}", f"{len(quoted)},2", panels)
columns = [m for m in METHODS if any(r["method"] == m[0] and r["variant"] == m[1] for r in error + peers)]
for reached in (1e-4, 1e-8):
    md.append(f"\nCost to an error of {reached:g}: CPU, wall ('-': not reached; blank: no such run)\n")
    table(None, ["scene", "dofs"] + [t for _, _, t, _ in columns],
          [[s, next(r["dofs"] for r in error if r["scene"] == s)] + [cell(s, m, v, reached) for m, v, _, _ in columns] for s in scenes])
for peer in ("GetFEM", "Siconos", "ff-Ipopt"):
    if not any(r["method"] == peer for r in peers):
        md.append(f"\n{peer} was not installed: left out.")
failed = [f"{r['method']} on {r['scene']}" for r in peers if r["variant"] == "failed"]
if failed:
    md.append("\nNo answer of a peer: " + "; ".join(failed) + ". (Siconos needs the inverse of S, which a body held by contact alone does "
              "not have: one node that is known to press and has no tangent is held for it; where there is none, it cannot run.)")
columns = [m for m in METHODS if m[0] in ("default", "GC3", "GCX", "GetFEM", "Siconos", "ff-Ipopt") and "r = 1" not in m[1]]
table("peers", [""] + [t for _, _, t, _ in columns],
      [[f"{QUOTED.get(s, s)}, to {reached:.0e}"] + [cell(s, m, v, reached) for m, v, _, _ in columns]
       for s in quoted for reached in (1e-4, 1e-8)]
      + [["least error, by scene"] + [least_error(m, v) for m, v, _, _ in columns]], shown=False)

GC3, GCX, CONDENSED = ("GC3", "hessian-ssor 1.5"), ("GCX", "SSOR 1.5"), ("condensed", "")
ratios = [cost_to(s, *GCX, 1e-8) / cost_to(s, *GC3, 1e-8) for s in scenes
          if max(cost_to(s, *GCX, 1e-8), cost_to(s, *GC3, 1e-8)) < math.inf]
if ratios:
    quote("GCX/GC3", span(ratios, ".1f"))
ratios = [cost_to(s, *CONDENSED, 1e-8) / min(cost_to(s, *m, 1e-8) for m in (GCX, GC3, ("multigrid", ""))) for s in scenes
          if cost_to(s, *CONDENSED, 1e-8) < math.inf]
if ratios:
    quote("condensed/iterations in 3D", span(ratios, ".1f"))

# --- preconditioners and regularization --------------------------------------------------------------------------
scene = next(r["scene"] for r in error if r["variant"] == "REG1")
of_scene = [r for r in error if r["scene"] == scene and r["method"] == "GC3"]
colours = ["#d06020", "#e0a000", "#2060c0", "#208040", "#8040a0", "#606060"]


def points(variant, x):
    return [(number(r[x]), number(r["error"])) for r in of_scene if r["variant"] == variant]


variants = [v for v in dict.fromkeys(r["variant"] for r in of_scene) if not v.startswith("REG")]
regularizations = ("REG1", "REG2", "REG3")
plot("regularization", "1300,560", "1,2",
     [(f"set title 'preconditioners of GC3, {scene.replace('_', ' ')}'; set xlabel 'iterations'; set key right top; "
       "set ylabel 'error in the energy norm'",
       [(v, f"lc rgb '{c}' pt 7", points(v, "iterations")) for v, c in zip(variants, colours)]),
      ("set title 'error floors of the regularizations'; set xlabel 'eps / max|u|'; set key left top",
       [(k, f"lc rgb '{c}' pt 7", points(k, "eps")) for k, c in zip(regularizations, colours)])])
for k in regularizations:
    floor = sorted(e / eps for eps, e in points(k, "eps") if 1e-7 <= eps <= 1e-3)
    quote(f"floor of {k}", f"{floor[len(floor) // 2]:.1f}")

# --- what a call costs by default -----------------------------------------------------------------------------------
MUS = ("mu0", "mu0.3", "mu1")


def two(r, *keys):
    return [f"{number(r[k]):.2f}" for k in keys]


md.append("\n## What a call costs by default\n")
md.append("CPU time on one thread in linear solves, medians; of a script's CHOLMOD CPU and wall time, each on the threads that it takes by "
          "default. Two bodies: in linear solves with the glued matrix T'AT, search, mortar and T'AT included.\n")
table("cost", ["block", "route", "mu = 0", "mu = 0.3", "mu = 1", "further increment", "over a script's CHOLMOD: CPU", "wall", "certificate"],
      [[r["scene"], r["route"]] + two(r, *MUS, "increment", "cpu", "wall") + [f"{number(r['residual']):.0e}"] for r in cost])
md.append("")
table("pair", ["block on a block", "route", "mu = 0", "mu = 0.3", "mu = 1", "further increment", "mortar, T'AT", "certificate"],
      [[f"{r['scene']}, {digits(r['dofs'])} dofs", r["route"]] + two(r, *MUS, "increment", "mortar") + [f"{number(r['residual']):.0e}"]
       for r in pair])
for dimension in ("2D", "3D"):
    of = [r for r in cost if r["scene"].startswith(dimension)]
    quote(f"call in {dimension}", span([number(r[k]) for r in of for k in MUS], ".1f"))
    for k in ("cpu", "wall"):
        quote(f"call in {dimension} over a script's CHOLMOD, {k}", span([number(r[k]) for r in of], ".1f"))
    quote(f"increment in {dimension}", span([100 * number(r["increment"]) for r in of], ".0f") + " %")

# --- 3D by multigrid -------------------------------------------------------------------------------------------------
md.append("\n## 3D by default\n")
md.append("The whole call in linear solves by CHOLMOD, in linear solves by multigrid (of two bodies: by sticking contact), and its "
          "iterations.\n")
table("multigrid", ["scene", "dofs", "contact nodes", "mu", "route", "units", "linear multigrid solves", "iterations"],
      [[r["scene"], digits(r["dofs"]), digits(r["contact"]), r["mu"], r["route"]] + two(r, "units", "linear") + [r["iterations"]]
       for r in multigrid])
ours = [number(r["units"]) for r in multigrid if r["route"] == "multigrid"]
if ours:
    quote("multigrid in 3D", span(ours, ".1f"))

# --- two bodies: CB1 -----------------------------------------------------------------------------------------------
BRICKS = [("ours", "frictionCG, dual mortar", "#c00000", 6), ("GetFEM nodal", "GetFEM, nodal brick", "#2060c0", 8),
          ("GetFEM raytracing", "GetFEM, integral by raytracing", "#208040", 4)]
md.append("\n## Two bodies: NAFEMS CB1\n")
md.append("Errors of the peak pressure p0 and of the half-width a against CPU seconds on one thread from the meshes to the field, on the "
          "same meshes, a/h = 4 to 32 on the slave; the table at a/h = 16. GetFEM: the nodal brick between non-matching meshes, and "
          "integral contact by raytracing, which is posed in the deformed configuration and keeps 0.7 % from Hertz. Its integral brick "
          "between non-matching meshes takes a pair of points up to a gap of 5 % of an element only: here it leaves the load on one.")
plot("roller", "1300,620", "1,2",
     [(f"set title 'CB1: {title}'; set ylabel 'error in %'; set format y '%g'; set xlabel 'CPU seconds'; "
       "set key outside bottom center maxcols 3",
       [(f"{t}, P{order}", f"lc rgb '{colour}' pt {point + (order == '2')} ps 1.4 lw 2" + (" dt 2" if order == "1" else ""),
         [(number(r["seconds"]), abs(number(r[column]))) for r in roller if r["method"] == m and r["order"] == order])
        for m, t, colour, point in BRICKS for order in ("1", "2")]) for column, title in (("p0", "peak pressure"), ("a", "half-width"))])


def pair_cell(order, method):
    for r in roller:
        if (r["method"], r["order"], r["cells"]) == (method, order, "16") and r["seconds"]:
            return f"{abs(number(r['p0'])):.2f}, {abs(number(r['a'])):.2f} % in {number(r['seconds']):.2g} s"
    return "-"


table("CB1", ["p0, a"] + [t for _, t, _, _ in BRICKS], [[f"P{order}"] + [pair_cell(order, m) for m, _, _, _ in BRICKS] for order in "12"])
if not any(r["method"] != "ours" for r in roller):
    md.append("\nGetFEM was not installed: left out.")

# --- total error --------------------------------------------------------------------------------------------------
md.append("\n## What a mesh deserves\n")
md.append("Total error against a fine mesh. The last two columns: the largest eps, and the largest tol, that add less than "
          "a tenth to the error of the mesh.\n")


def deserved(mu, n):
    of = [r for r in total if r["mu"] == mu and r["n"] == n]
    mesh = next(number(r["error"]) for r in of if r["what"] == "mesh")
    largest = [max((number(r["value"]) for r in of if r["what"] == w and number(r["error"]) <= 1.1 * mesh), default=math.nan)
               for w in ("eps", "tol")]
    return [f"{mesh:.1e}"] + [f"{v:.0e}" for v in largest]


table(None, ["mu", "n", "error of the mesh", "eps / max\\|u\\|", "tol"],
      [[mu, n] + deserved(mu, n) for mu, n in dict.fromkeys((r["mu"], r["n"]) for r in total)])
plot("total_error", "1300,560", "1,2",
     [(f"set title 'mesh + {error_of}, mu = 1'; set xlabel '{label}'; set ylabel 'total error'",
       [(f"n = {n}", f"lc rgb '{c}' pt 7", [(number(r["value"]), number(r["error"])) for r in total
                                          if r["mu"] == "1" and r["n"] == n and r["what"] == what])
        for n, c in zip(dict.fromkeys(r["n"] for r in total), colours)])
      for what, error_of, label in (("eps", "regularization", "eps / max|u|"), ("tol", "algebra", "tol"))])
md.append("The rule: a mesh of relative error delta deserves regeps = delta max|u|/3 and tol = delta/10; beyond, the run time buys "
          "nothing. The defaults stay out of the way of any mesh: the default route does not regularize at all, and GC3 takes "
          "1e-8 max|u|, less where tol asks for it.")

# --- stability ------------------------------------------------------------------------------------------------------
by_scene = defaultdict(dict)
for r in stress:
    by_scene[(r["scene"], r["parameter"])][r["method"]] = r
by_default = [m["default"] for m in by_scene.values() if "default" in m]
count = quote("extreme scenes", str(len(by_default)))
bad = quote("extreme scenes, unsolved", str(sum(r["status"] not in ("converged", "no_equilibrium") for r in by_default)))
md.append(f"\n## Stability\n\n{count} scenes by the default, as many by GC3 (omega 1); {bad} unsolved by the default. 'attainable' is what "
          "rounding allows, eps_machine | |A||u| | in the norm of the certificate; 'violation' is the independent judge's.\n")


def stability(r, *keys):
    return [r.get("status", "")] + [f"{number(r[k]):.2g}" if r.get(k) else "" for k in keys]


table(None, ["scene", "parameter", "default: status", "certificate", "attainable", "steps", "units", "violation", "GC3: status",
             "certificate", "iterations", "units"],
      [[*key] + stability(m.get("default", {}), "certificate", "attainable", "iterations", "units", "violation")
       + stability(m.get("GC3", {}), "certificate", "iterations", "units") for key, m in by_scene.items()])

# --- random scenes, what is left out, leaks, and examples -------------------------------------------------------------


def random_row(line):
    """'default: 10000 scenes from seed 1: converged 9000 stagnated 2 ...'"""
    method, of, counts = (part.strip() for part in line.split(":", 2))
    words, count = counts.split(), int(of.split()[0])
    by = dict(zip(words[::2], map(int, words[1::2])))
    solved, proved = by.pop("converged", 0), by.pop("no_equilibrium", 0)
    left = sum(by.values())
    return [method, str(count), str(solved), str(proved), f"{left} ({100 * left / count:.2f} %)",
            ", ".join(f"`{k}` {n}" for k, n in by.items()) or "none"]


with open("random.txt") as f:
    lines = f.read().splitlines()
md.append(f"\n## Random scenes\n\nFrom seed {lines[0].split('seed ')[1].split(':')[0]}\n")
table("random", ["method", "scenes", "converged", "proved to have no equilibrium", "not solved", "by reason"], map(random_row, lines))
for name, title in (("left_out", "What is left out"), ("leaks", "Leaks")):
    if os.path.exists(f"{name}.txt"):
        with open(f"{name}.txt") as f:
            md.append(f"\n## {title}\n\n```\n" + f.read().strip() + "\n```")
with open("left_out.txt") as f:
    quote("no friction", span([float(line.split("costs ")[1].split()[0]) for line in f if " costs " in line]))
with open("examples.txt") as f:
    figures += f.read().splitlines()

for name, lines in (("figures.txt", figures), ("report.md", md)):
    with open(name, "w") as f:
        f.write("\n".join(lines) + "\n")
print("report/report.md, with its pictures")
