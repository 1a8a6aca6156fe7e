"""From the measured CSV files of the current folder: the pictures (gnuplot) and report.md. Standard library only."""
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


error, peers, ipopt, stress, total = (rows(n) for n in ("error.csv", "peers.csv", "ipopt.csv", "stress.csv", "total.csv"))
history = rows("history.csv")
md = []


def plot(name, size, commands):
    with open(name + ".gp", "w") as f:
        f.write(f"set terminal pngcairo size {size} font 'DejaVu Sans,11'; set output '{name}.png'\n"
                "set grid lc rgb '#dddddd'; set format y '10^{%L}'; set tics nomirror\n" + commands)
    subprocess.run(["gnuplot", name + ".gp"], check=True)


def block(points):
    return "\n".join(f"{x} {y}" for x, y in points if x > 0 and y > 0) + "\ne\n"


def curves(series):
    """plot '-' with the series (title, style, points)."""
    series = [(t, s, [(x, y) for x, y in p if x > 0 and y > 0]) for t, s, p in series]
    series = [(t, s, p) for t, s, p in series if p]
    return ("plot " + ", ".join(f"'-' with linespoints {style} title \"{title}\"" for title, style, _ in series) + "\n"
            + "".join(block(p) for _, _, p in series))


# --- error against run time -------------------------------------------------------------------------------------
OURS = [("condensed", "Newton", "condensed (default in 2D)", "lc rgb '#c00000' pt 3 ps 2.5 lw 3"),
        ("GC3", "hessian-ssor 1.5", "GC3", "lc rgb '#d06020' pt 7 lw 2"),
        ("GCX", "SSOR 1.5", "GCX", "lc rgb '#e0a000' pt 5 lw 2"),
        ("GC2", "hessian-ssor 1.5", "GC2", "lc rgb '#b08060' pt 9"),
        ("GC1", "hessian-ssor 1.5", "GC1", "lc rgb '#907050' pt 11"),
        ("SORP", "omega 1.8", "SORP", "lc rgb '#606060' pt 13")]
PEERS = [("GetFEM", "nodal Newton; r = 0.1 diag A", "GetFEM, r = 0.1 diag A", "lc rgb '#2060c0' pt 4 lw 2"),
         ("GetFEM", "nodal Newton; r = 1 diag A", "GetFEM, r = diag A", "lc rgb '#70a0e0' pt 6"),
         ("Siconos", "NSN_AC on the condensed system", "Siconos NSN\\\\_AC on our S", "lc rgb '#208040' pt 8 lw 2"),
         ("ff-Ipopt", "bounds", "ff-Ipopt", "lc rgb '#8040a0' pt 10"),
         ("ff-Ipopt", "epigraph in a fixed point", "ff-Ipopt, fixed point", "lc rgb '#8040a0' pt 10")]


def envelope(points):
    """The best error reached by each cost."""
    best, kept = math.inf, []
    for x, y in sorted(points):
        if y < best:
            best = y
            kept.append((x, y))
    return kept


def panel(scene, x):
    series = []
    for method, variant, title, style in OURS:
        series.append((title, style, [(number(r[x]), max(number(r["error"]), 1e-16)) for r in error
                                      if r["scene"] == scene and r["method"] == method and r["variant"] == variant
                                      and r["status"] in ("converged", "regularized")]))
    if x == "units":
        for method, variant, title, style in PEERS:
            series.append((title, style, envelope(
                [(number(r[x]), max(number(r["error"]), 1e-16)) for r in peers + ipopt
                 if r["scene"] == scene and r["method"] == method and r["variant"] == variant])))
        series.append(("linear solve: PCG SSOR", "lc rgb '#000000' dt 2 pt 1",
                       [(number(r[x]), number(r["error"])) for r in error if r["scene"] == scene
                        and r["variant"] == "PCG SSOR" and r["status"] == "converged"]))
    return series


TITLE = {"block2d_n40_mu0.3": "block 40 x 40, mu = 0.3", "block2d_n80_mu1": "block 80 x 80, mu = 1",
         "block2d_n80_mu0": "block 80 x 80, no friction", "block2d_n160_mu1": "block 160 x 160, mu = 1",
         "block2d_n160_mu0.3": "block 160 x 160, mu = 0.3", "block2d_n320_mu1": "block 320 x 320, mu = 1",
         "block3d_n8_mu0.3": "block 8^3, mu = 0.3", "block3d_n16_mu0.3": "block 16^3, mu = 0.3",
         "block3d_n24_mu0.3": "block 24^3, mu = 0.3", "dovetail_q36": "dovetail-like root", "hertz_c16": "Hertz, no friction"}
scenes = list(dict.fromkeys(r["scene"] for r in error))


def figure(name, wanted, x, label):
    wanted = [s for s in wanted if s in scenes] or scenes[:4]
    text = (f"set multiplot layout {(len(wanted) + 1) // 2},2; set logscale xy; set yrange [1e-15:2]; set xlabel '{label}'\n"
            "set ylabel 'error in the energy norm'; set key font ',9' outside right center samplen 1 Left reverse\n")
    for scene in wanted:
        text += f"set title '{TITLE.get(scene, scene.replace('_', ' '))}'\n"
        if x == "units":
            text += "set arrow 1 from 1, graph 0 to 1, graph 1 nohead lw 2 lc rgb '#bbbbbb' back\nset xrange [0.08:200]\n"
        text += curves(panel(scene, x))
    plot(name, f"1600,{560 * ((len(wanted) + 1) // 2)}", text + "unset multiplot\n")


FRONT = ["block2d_n160_mu1", "block3d_n16_mu0.3", "dovetail_q36", "hertz_c16"]
figure("error_time", FRONT, "units", "cost, in units of one linear solve (CHOLMOD, grey line)")
figure("error_iterations", FRONT, "iterations", "iterations")

md.append("# Measured: error against run time, stability, and what is left out\n")
md.append("Made by `make report` from its own runs alone. Unit of cost: one linear solve of the same matrix (CHOLMOD, the "
          "best of AMD, METIS and FreeFEM's own, analyse + factor + solve), CPU time, one thread. Errors of fields: energy norm, "
          "relative.\n")
md.append("![error against run time](error_time.png)\n")


def cost_to(reached, points):
    ok = [c for c, e in points if e <= reached]
    return f"{min(ok):.2f}" if ok else "-"


def table(reached):
    md.append(f"\nCost to an error of {reached:g}, in linear solves ('-': not reached; blank: no such run)\n")
    names = [(m, v, t) for m, v, t, _ in OURS + PEERS[:3]] + [("ff-Ipopt", None, "ff-Ipopt"), ("linear solve", "PCG SSOR", "(linear) PCG SSOR")]
    md.append("| scene | dofs | " + " | ".join(t.replace("\\\\_", "_") for _, _, t in names) + " |")
    md.append("|---" * (len(names) + 2) + "|")
    for scene in scenes:
        line = [scene, next(r["dofs"] for r in error if r["scene"] == scene)]
        for method, variant, _ in names:
            mine = [r for r in error + peers + ipopt if r["scene"] == scene and r["method"] == method
                    and (variant is None or r["variant"] == variant) and r.get("status", "converged") in ("converged", "regularized", None)]
            points = [(number(r["units"]), number(r["error"])) for r in mine]
            attempted = any(r["scene"] == scene and r["method"] == method for r in error + peers + ipopt)
            line.append(cost_to(reached, points) if points else ("-" if attempted else ""))
        md.append("| " + " | ".join(line) + " |")


table(1e-4)
table(1e-8)
failed = [f"{r['method']} on {r['scene']}" for r in peers if r["variant"] == "failed"]
present = {r["method"] for r in peers + ipopt}
for peer in ("GetFEM", "Siconos", "ff-Ipopt"):
    if peer not in present:
        md.append(f"\n{peer} was not installed: left out.")
if failed:
    md.append("\nNo answer of a peer: " + "; ".join(failed) + ". (Siconos needs the inverse of S, which a body held by contact alone does "
              "not have: one node that is known to press and has no tangent is held for it; where there is none, it cannot run.)")

# --- preconditioners and regularization --------------------------------------------------------------------------
scene = next((s for s in ("block2d_n80_mu1", "block2d_n40_mu1") if s in scenes), scenes[0])
variants = list(dict.fromkeys(r["variant"] for r in error if r["scene"] == scene and r["method"] == "GC3"
                              and not r["variant"].startswith("REG")))
colours = ["#d06020", "#e0a000", "#2060c0", "#208040", "#8040a0", "#606060"]
text = ("set multiplot layout 1,2; set logscale xy; set key font ',9' right top; set ylabel 'error in the energy norm'\n"
        f"set title 'preconditioners of GC3, {TITLE.get(scene, scene)}'; set xlabel 'iterations'\n")
text += curves([(v, f"lc rgb '{c}' pt 7", [(number(r["iterations"]), number(r["error"])) for r in error
                                         if r["scene"] == scene and r["method"] == "GC3" and r["variant"] == v])
                for v, c in zip(variants, colours)])
text += "set title 'error floors of the regularizations'; set xlabel 'eps / max|u|'; set key left top; set format x '10^{%L}'\n"
text += curves([(f"REG{k}", f"lc rgb '{c}' pt 7", [(number(r["eps"]), number(r["error"])) for r in error
                                                if r["scene"] == scene and r["variant"] == f"REG{k}"])
                for k, c in ((1, "#c03030"), (2, "#2060c0"), (3, "#208040"))])
plot("regularization", "1300,560", text + "unset multiplot\n")
md.append("\n![preconditioners and regularizations](regularization.png)\n")
md.append(f"\nError floors of the regularizations, {TITLE.get(scene, scene)}, tol 1e-8; iterations of GC3 (omega 1.5)\n")
md.append("| eps / max\\|u\\| | REG1 | REG2 | REG3 | iterations |\n|---|---|---|---|---|")
floors = defaultdict(dict)
for r in error:
    if r["scene"] == scene and r["variant"].startswith("REG"):
        floors[number(r["eps"])][r["variant"]] = r
for eps in sorted(floors, reverse=True):
    f = floors[eps]
    md.append(f"| {eps:.0e} | " + " | ".join(f"{number(f[k]['error']):.1e}" if k in f else "" for k in ("REG1", "REG2", "REG3"))
              + " | " + "/".join(f[k]["iterations"] for k in ("REG1", "REG2", "REG3") if k in f) + " |")

# --- certificates of single runs -----------------------------------------------------------------------------------
text = "set multiplot layout 1,2; set logscale xy; set key font ',9' left bottom; set ylabel 'certificate'\n"
for s in [s for s in ("block2d_n80_mu1", "dovetail_q36", "block2d_n40_mu1", "dovetail_q18") if s in scenes][:2]:
    text += f"set title '{TITLE.get(s, s.replace('_', ' '))}: single runs'; set xlabel 'units of one linear solve'\n"
    text += curves([(m, f"lc rgb '{c}' pt 7 ps 0.3", [(number(r["units"]), number(r["certificate"])) for r in history
                                                   if r["scene"] == s and r["method"] == m])
                    for m, c in (("GC1", "#907050"), ("GC2", "#b08060"), ("GC3", "#d06020"), ("GCX", "#e0a000"), ("SORP", "#606060"))])
plot("history", "1300,560", text + "unset multiplot\n")
md.append("\n![certificates along single runs](history.png)\n")

# --- two bodies: CB1 -----------------------------------------------------------------------------------------------
roller = rows("roller.csv")
if roller:
    md.append("\n## Two bodies: NAFEMS CB1\n")
    md.append("Errors of the peak pressure p0 and of the half-width a against CPU seconds from the meshes to the field, on the "
              "same meshes, a/h = 4 to 32 on the slave. GetFEM: the nodal brick between non-matching meshes, and integral contact by "
              "raytracing, which is posed in the deformed configuration and keeps 0.7 % from Hertz. Its integral brick between "
              "non-matching meshes takes a pair of points up to a gap of 5 % of an element only: here it leaves the load on one.\n")
    text = "set multiplot layout 1,2; set logscale xy; set key font ',9' outside bottom center maxcols 3; set xlabel 'CPU seconds'; set format x '10^{%L}'\n"
    for column, title in (("p0", "peak pressure"), ("a", "half-width")):
        text += f"set title 'CB1: {title}'; set ylabel 'error in %'; set format y '%g'\n"
        text += curves([(f"{t}, P{order}", f"lc rgb '{colour}' pt {point + (order == '2')} ps 1.4 lw 2" + (" dt 2" if order == "1" else ""),
                         [(number(r["seconds"]), abs(number(r[column]))) for r in roller if r["method"] == m and r["order"] == order])
                        for m, t, colour, point in (("ours", "dual mortar", "#c00000", 6), ("GetFEM nodal", "GetFEM, nodal", "#2060c0", 8),
                                                    ("GetFEM raytracing", "GetFEM, raytracing", "#208040", 4)) for order in ("1", "2")])
    plot("roller", "1300,620", text + "unset multiplot\n")
    md.append("![CB1: error against run time](roller.png)\n")
    md.append("| a/h | | dofs | " + " | ".join(f"{m}: s | p0 % | a %" for m in ("ours", "GetFEM nodal", "GetFEM raytracing")) + " |\n" + "|---" * 12 + "|")
    for order in ("1", "2"):
        for r in (r for r in roller if r["method"] == "ours" and r["order"] == order):
            line = [r["cells"], "P" + order, r["dofs"]]
            for m in ("ours", "GetFEM nodal", "GetFEM raytracing"):
                mine = next((q for q in roller if q["method"] == m and q["order"] == order and q["cells"] == r["cells"] and q["seconds"]), None)
                line += [f"{number(mine[k]):.2g}" if mine else "-" for k in ("seconds", "p0", "a")]
            md.append("| " + " | ".join(line) + " |")
    if not any(r["method"] != "ours" for r in roller):
        md.append("\nGetFEM was not installed: left out.")

# --- total error --------------------------------------------------------------------------------------------------
if total:
    md.append("\n## What a mesh deserves\n")
    md.append("Total error against a fine mesh. The last two columns: the largest eps, and the largest tol, that add less than "
              "a tenth to the error of the mesh.\n")
    md.append("| mu | n | error of the mesh | eps / max\\|u\\| | tol |\n|---|---|---|---|---|")
    for mu in dict.fromkeys(r["mu"] for r in total):
        for n in dict.fromkeys(r["n"] for r in total if r["mu"] == mu):
            mine = [r for r in total if r["mu"] == mu and r["n"] == n]
            mesh = next(number(r["error"]) for r in mine if r["what"] == "mesh")
            ok = {w: max((number(r["value"]) for r in mine if r["what"] == w and number(r["error"]) <= 1.1 * mesh), default=math.nan)
                  for w in ("eps", "tol")}
            md.append(f"| {mu} | {n} | {mesh:.1e} | {ok['eps']:.0e} | {ok['tol']:.0e} |")
    text = "set multiplot layout 1,2; set logscale xy; set key font ',9' left top; set ylabel 'total error'; set format x '10^{%L}'\n"
    for what, label in (("eps", "eps / max|u|"), ("tol", "tol")):
        text += f"set title 'mesh + {'regularization' if what == 'eps' else 'algebra'}, mu = 1'; set xlabel '{label}'\n"
        ns = list(dict.fromkeys(r["n"] for r in total))
        text += curves([(f"n = {n}", f"lc rgb '{c}' pt 7", [(number(r["value"]), number(r["error"])) for r in total
                                                         if r["mu"] == "1" and r["n"] == n and r["what"] == what])
                        for n, c in zip(ns, colours)])
    plot("total_error", "1300,560", text + "unset multiplot\n")
    md.append("\n![total error](total_error.png)\n")
    md.append("\nThe rule: a mesh of relative error delta deserves regeps = delta max|u|/3 and tol = delta/10; beyond, the run time buys "
              "nothing. The defaults stay out of the way of any mesh: the default route does not regularize at all, and GC3 takes "
              "1e-8 max|u|, less where tol asks for it.\n")

# --- 3D by multigrid -------------------------------------------------------------------------------------------------
multigrid = rows("multigrid3d.csv")
if multigrid:
    md.append("\n## 3D by the scalable route\n")
    md.append("What `auto` takes: the whole call in units of the best linear solve of the same matrix by CHOLMOD, and of one linear "
              "solve by the same hierarchy (two bodies: the unit is the condensed route, and sticking contact by multigrid).\n")
    md.append("| scene | dofs | contact nodes | mu | route | units | linear multigrid solves | cycles | peak MB | certificate |\n" + "|---" * 10 + "|")
    for r in multigrid:
        md.append("| " + " | ".join([r["scene"], r["dofs"], r["contact"], r["mu"], r["route"]] + [f"{number(r[k]):.2f}" for k in ("units", "linear")]
                                    + [r["iterations"], r["megabytes"], r["certificate"]]) + " |")

# --- stability ------------------------------------------------------------------------------------------------------
if stress:
    md.append("\n## Stability\n")
    bad = [r for r in stress if r["method"] == "default" and r["status"] not in ("converged", "no_equilibrium")]
    md.append(f"{sum(r['method'] == 'default' for r in stress)} scenes by the default, as many by GC3 (omega 1); {len(bad)} unsolved by the default. 'attainable' is what rounding allows, eps_machine | |A||u| | in the norm "
              "of the certificate; 'violation' is the independent judge's.\n")
    md.append("| scene | parameter | default: status | certificate | attainable | steps | units | violation | GC3: status | "
              "certificate | iterations | units |\n" + "|---" * 12 + "|")
    pairs = defaultdict(dict)
    for r in stress:
        pairs[(r["scene"], r["parameter"])][r["method"]] = r
    for (scene_name, parameter), p in pairs.items():
        d, g = p.get("default"), p.get("GC3")
        short = lambda r, *keys: [("" if r is None or r[k] == "" else f"{number(r[k]):.2g}") for k in keys]
        md.append("| " + " | ".join(
            [scene_name, parameter, d["status"] if d else ""] + short(d, "certificate", "attainable", "iterations", "units", "violation")
            + [g["status"] if g else ""] + short(g, "certificate", "iterations", "units")) + " |")

for name, title in (("random.txt", "Random scenes"), ("left_out.txt", "What is left out"), ("leaks.txt", "Leaks")):
    if os.path.exists(name):
        md.append(f"\n## {title}\n\n```\n" + open(name).read().strip() + "\n```")

# --- what README and manual quote, by name: tests/figures compares them ---------------------------------------------
figures = []


def quote(name, *lines):
    figures.extend(f"{name}\t{line}" for line in lines)


def span(values, digits=".1f"):
    low, high = (f"{v:{digits}}" for v in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def cost_row(r, extra=()):
    cells = [r["scene"]] + [f"{number(r[k]):.2f}" for k in ("mu0", "mu0.3", "mu1", "increment", *extra)]
    return "| " + " | ".join(cells + [f"{number(r['residual']):.0e}"]) + " |"


cost, pair = rows("cost.csv"), rows("costPair.csv")
if cost:
    quote("cost", "| block | mu = 0 | mu = 0.3 | mu = 1 | further increment | over a script's CHOLMOD: CPU | wall | certificate |",
          "|---" * 8 + "|", *(cost_row(r, ("cpu", "wall")) for r in cost))
for r in pair:
    r["scene"] = f"{r['scene']}, {int(r['dofs']):,} dofs".replace(",", " ").replace("D  ", "D, ")
if pair:
    quote("pair", "| block on a block | mu = 0 | mu = 0.3 | mu = 1 | further increment | mortar, T'AT | certificate |",
          "|---" * 7 + "|", *(cost_row(r, ("mortar",)) for r in pair))


def times_to(reached, dimension):
    """By scene of this dimension, the cost of each method to this error where it was reached."""
    found = defaultdict(dict)
    for r in error:
        if f"block{dimension}d" in r["scene"] or (dimension == 2 and "block" not in r["scene"]):
            if r["status"] in ("converged", "regularized") and number(r["error"]) <= reached:
                key = r["method"] if r["variant"] in ("Newton", "hessian-ssor 1.5", "SSOR 1.5", "omega 1.8") else None
                found[r["scene"]][key] = min(number(r["units"]), found[r["scene"]].get(key, math.inf))
    return [c for c in found.values()]


both = times_to(1e-8, 2) + times_to(1e-8, 3)
if any("GCX" in c and "GC3" in c for c in both):
    quote("GCX/GC3", span([c["GCX"] / c["GC3"] for c in both if "GCX" in c and "GC3" in c]))
solid = [c["condensed"] / min(c.get("GCX", math.inf), c.get("GC3", math.inf)) for c in times_to(1e-8, 3)
         if "condensed" in c and ("GCX" in c or "GC3" in c)]
if solid:
    quote("condensed/iterations in 3D", span(solid))
for k in ("REG1", "REG2", "REG3"):
    floor = [number(f[k]["error"]) / eps for eps, f in floors.items() if k in f and 1e-7 <= eps <= 1e-3]
    if floor:
        quote(f"floor of {k}", f"{sorted(floor)[len(floor) // 2]:.1f}")
if stress:
    quote("extreme scenes", str(sum(r["method"] == "default" for r in stress)))
    quote("extreme scenes, unsolved", str(len(bad)))


QUOTED = [("block2d_n160_mu1", "block 160 x 160, mu = 1"), ("block3d_n24_mu0.3", "block 24^3, mu = 0.3"),
          ("dovetail_q36", "dovetail-like root"), ("hertz_c16", "Hertz, no friction")]
COLUMNS = [("condensed", "frictionCG, condensed"), ("GCX", "GCX"), ("GetFEM", "GetFEM, nodal Newton"),
           ("Siconos", "Siconos, NSN_AC on our condensed system"), ("ff-Ipopt", "FreeFEM's ff-Ipopt")]


def runs(scene, method):
    """(cost, error) of every run of a method on a scene that ended well, whatever its parameters."""
    return [(number(r["units"]), number(r["error"])) for r in error + peers + ipopt
            if r["scene"] == scene and r["method"] == method
            and r.get("status", "converged") in ("converged", "regularized", None)
            and not math.isnan(number(r["units"]))]


def accuracy(method):
    """The least error on each scene where the method ran: least and largest of those."""
    least = [min(e for _, e in runs(s, method)) for s in scenes if runs(s, method)]
    low, high = (f"{v:.0e}" for v in (min(least), max(least))) if least else ("", "")
    return low if low == high else f"{low} to {high}"


def cell(scene, method, reached):
    tried = any(r["scene"] == scene and r["method"] == method for r in error + peers + ipopt)
    return cost_to(reached, runs(scene, method)) if tried else ""


peer_rows = [f"| {title}, to {reached:.0e} | " + " | ".join(cell(s, m, reached) for m, _ in COLUMNS) + " |"
             for s, title in QUOTED if s in scenes for reached in (1e-4, 1e-8)]
if peers or ipopt:
    quote("peers", "| | " + " | ".join(title for _, title in COLUMNS) + " |", "|---" * (len(COLUMNS) + 1) + "|", *peer_rows,
          "| least error, by scene | " + " | ".join(accuracy(m) for m, _ in COLUMNS) + " |")


def random_row(line):
    """'default: 10000 scenes from seed 1: converged 9000 stagnated 2 ...' as a row of a table."""
    method, scene_text, counts = (part.strip() for part in line.split(":", 2))
    words = counts.split()
    by = dict(zip(words[::2], map(int, words[1::2])))
    scenes_run = int(scene_text.split()[0])
    solved, proved = by.pop("converged", 0), by.pop("no_equilibrium", 0)
    left = sum(by.values())
    reasons = ", ".join(f"`{k}` {n}" for k, n in by.items()) or "none"
    return f"| {method} | {scenes_run} | {solved} | {proved} | {left} ({100 * left / scenes_run:.2f} %) | {reasons} |"


PAIR_PEERS = [("ours", "frictionCG, dual mortar"), ("GetFEM nodal", "GetFEM, nodal brick"),
              ("GetFEM raytracing", "GetFEM, integral by raytracing")]


def pair_cell(order, method):
    """Errors of p0 and a in %, and CPU seconds, at a/h = 16."""
    for r in roller:
        if (r["method"], r["order"], r["cells"]) == (method, order, "16") and r["seconds"]:
            return f"{abs(number(r['p0'])):.2f}, {abs(number(r['a'])):.2f} % in {number(r['seconds']):.2g} s"
    return "-"


if roller:
    quote("CB1", "| p0, a | " + " | ".join(title for _, title in PAIR_PEERS) + " |", "|---" * 4 + "|",
          *(f"| P{order} | " + " | ".join(pair_cell(order, m) for m, _ in PAIR_PEERS) + " |" for order in "12"))
if multigrid:
    quote("multigrid", "| scene | dofs | contact nodes | mu | route | units | linear multigrid solves | cycles | MB |", "|---" * 9 + "|",
          *(f"| {r['scene']} | {int(r['dofs']):,} | {int(r['contact']):,} | {r['mu']} | {r['route']} | {number(r['units']):.2f} | "
            f"{number(r['linear']):.2f} | {r['iterations']} | {number(r['megabytes']):.0f} |".replace(",", " ") for r in multigrid))
if os.path.exists("random.txt"):
    quote("random", "| method | scenes | converged | proved to have no equilibrium | not solved | by reason |",
          "|---" * 6 + "|", *(random_row(line) for line in open("random.txt") if line.strip()))
if os.path.exists("left_out.txt"):
    ratios = [float(line.split("costs ")[1].split()[0]) for line in open("left_out.txt") if " costs " in line]
    quote("no friction", span(ratios, ".2f"))
for line in open("examples.txt") if os.path.exists("examples.txt") else ():
    figures.append(line.rstrip())
with open("figures.txt", "w") as f:
    f.write("\n".join(figures) + "\n")

with open("report.md", "w") as f:
    f.write("\n".join(md) + "\n")
print("report/report.md, error_time.png, error_iterations.png, regularization.png, history.png, total_error.png")
