#!/usr/bin/python3
"""Whether the default takes the cheapest route: runs routes.edp, prints what each route cost over the cheapest named one,
and the factors by which the plan's estimates are off (plugin/core/cost.cpp).

    python3 tests/bench/routes.py [what routes.edp has printed]

Run in build/, with FF_LOADPATH and FF_INCLUDEPATH as the Makefile sets them."""
import math
import os
import re
import statistics
import subprocess
import sys

METHODS = ("auto", "condensed", "multigrid", "GCX")


def output():
    if len(sys.argv) > 1:
        return open(sys.argv[1], encoding="utf-8").read()
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "routes.edp")
    program = os.environ.get("FF_PROGRAM", "FreeFem++-nw")
    environment = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")
    return subprocess.run([program, "-nw", "-v", "0", script], env=environment, check=True, text=True,
                          stdout=subprocess.PIPE).stdout


def scenes(text):
    """name -> method -> (seconds, status); and the estimates of each scene"""
    costs, estimates, weighed = {}, {}, {}
    for line in text.splitlines():
        found = re.search(r"a factorization at about (\S+) s, multigrid at (\S+) s", line)
        if found:
            weighed = {"condensed": float(found[1]), "multigrid": float(found[2])}
        if line.startswith("route,"):
            _, name, method, seconds, status, _, _ = line.split(",")
            costs.setdefault(name, {})[method] = (float(seconds), int(status))
            estimates.setdefault(name, weighed)
    return costs, estimates


def main():
    costs, estimates = scenes(output())
    worse = []
    for name, of in costs.items():
        named = {m: s for m, (s, status) in of.items() if m != "auto" and status == 0}
        best = min(named, key=named.get)
        over = of["auto"][0] / named[best]
        worse.append(over)
        print(f"{name:28} " + "  ".join(f"{m} {of[m][0]:.4f}" + ("" if of[m][1] == 0 else "!") for m in METHODS)
              + f"  default over {best}: {over:.2f}")
    within = [sum(q <= bound for q in worse) for bound in (1.25, 2)]
    print(f"{len(worse)} scenes: within 1.25 in {within[0]}, within 2 in {within[1]}, at most {max(worse):.2f}")
    for dimension in ("2D", "3D"):
        for method in ("condensed", "multigrid"):
            off = [of[method][0] / estimates[name][method] for name, of in costs.items()
                   if name.startswith(dimension) and of[method][1] == 0 and estimates[name]]
            spread = math.exp(statistics.pstdev([math.log(q) for q in off]))
            print(f"{dimension} {method}: takes {statistics.median(off):.2f} of its estimate, within a factor of {spread:.2f}")


main()
