#!/usr/bin/env python3
"""One-line faults put into plugin/core, one at a time: each must be noticed by a test.

  run.py BUILD JOBS [word ...]     only the mutants of files whose path has one of the words

list.txt holds them:

  @ core/gradient/line_search.cpp      the file, below plugin/
  - text                               stands once in the file
  + text                               what stands there instead
  ? reason                             only where no test can notice: the same answers, other costs

The unit tests are tried first, the quick ones before the long ones, then the scripts. BUILD holds the objects and
the plugin of a build at -O1, and unit_tests. Prints a line each, and those that nothing noticed again at the end.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
LONG = "RandomScenes.*:*200RandomScenes*:Faults.*:*LargeFriction*:*LargeSlip*:*Arrival*"
SECONDS = 240  # a fault that makes a test run for ever is noticed, too


class Mutant:
    def __init__(self, path, old, new, line):
        self.path, self.old, self.new, self.line = path, old, new, line
        self.reason = None

    def __str__(self):
        return f"{self.path}: {self.old.strip()}  ->  {self.new.strip()}"


def read_list():
    mutants, path, old = [], None, None
    with open(os.path.join(HERE, "list.txt")) as f:
        for number, line in enumerate(f, 1):
            mark, text = line[:2], line[2:].rstrip("\n")
            if mark == "@ ":
                path = text.strip()
            elif mark == "- ":
                old = text
            elif mark in ("+ ", "+\n"):
                mutants.append(Mutant(path, old, text, number))
            elif mark == "? ":
                mutants[-1].reason = text
    return mutants


def run(command, log, seconds=SECONDS, **more):
    """True where the command ends well in time."""
    try:
        return subprocess.run(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, timeout=seconds,
                              **more).returncode == 0
    except subprocess.TimeoutExpired:
        return False


class Build:
    """How make builds the plugin and its tests: its own commands, with one object exchanged."""

    def __init__(self, build):
        self.build = build
        self.lines = {}
        for target in ("unit_tests", "frictionCG.so"):
            out = subprocess.run(["make", "-n", "-B", f"BUILD={build}", "CXXFLAGS=-O1", f"{build}/{target}"],
                                 cwd=ROOT, capture_output=True, text=True, check=True).stdout
            for line in out.replace("\\\n", " ").splitlines():
                made = re.search(r" -o (\S+)", line)
                if made:
                    self.lines[made.group(1)] = line

    def objects(self, path):
        """The objects that a file of plugin/core goes into."""
        if path.endswith(".cpp"):
            return [f"{self.build}/{path[:-4]}.o"]
        return [o for o in self.lines if o.startswith(f"{self.build}/core/")]

    def command(self, target, exchange):
        line = self.lines[f"{self.build}/{target}" if "/" not in target else target]
        for old, new in exchange.items():
            line = re.sub(r"(?<=\s)" + re.escape(old) + r"(?=\s|$)", new, line)
        return line


def tests_notice(folder, build, log):
    unit = os.path.join(folder, "unit_tests")
    for tests in ("-" + LONG, LONG):
        if not run([unit, f"--gtest_filter={tests}", "--gtest_fail_fast"], log, cwd=folder):
            return "unit tests"
    env = dict(os.environ, BUILD=os.path.relpath(folder, ROOT))
    plugins = os.environ.get("FF_PLUGINS", "/usr/lib/freefem++")
    idp = os.environ.get("FF_IDP", "/usr/include/freefem++/idp")
    env["FF_LOADPATH"] = f"{folder};{plugins}"
    env["FF_INCLUDEPATH"] = f"{folder};{idp}"
    scripts = sorted(s for s in os.listdir(os.path.join(ROOT, "tests/edp")) if s.endswith(".edp"))
    if not run(["bash", "tests/run"] + [f"tests/edp/{s}" for s in scripts], log, 600, cwd=ROOT, env=env):
        return "scripts"
    return None


def noticed(mutant, build):
    """Who notices the fault, or None."""
    source = os.path.join(ROOT, "plugin", mutant.path)
    with open(source) as f:
        text = f.read()
    if text.count(mutant.old) != 1:
        return f"list.txt:{mutant.line}: stands {text.count(mutant.old)} times in {mutant.path}"
    folder = tempfile.mkdtemp(prefix="mutant", dir=build.build)
    try:
        with open(os.path.join(folder, "log"), "w") as log:
            # the fault in a copy of the core, found before the true one
            copy = os.path.join(folder, "plugin")
            shutil.copytree(os.path.join(ROOT, "plugin/core"), os.path.join(copy, "core"))
            with open(os.path.join(copy, mutant.path), "w") as f:
                f.write(text.replace(mutant.old, mutant.new))
            exchange = {}
            for number, made in enumerate(build.objects(mutant.path)):
                name = os.path.join(folder, f"{number}.o")
                command = build.command(made, {made: name}).replace("plugin/core", f"{copy}/core")
                if not run(command, log, shell=True, cwd=ROOT):
                    return "compiler"
                exchange[made] = name
            for target in ("unit_tests", "frictionCG.so"):
                exchange[f"{build.build}/{target}"] = os.path.join(folder, target)
                if not run(build.command(target, exchange), log, shell=True, cwd=ROOT):
                    return "linker"
            for idp in os.listdir(os.path.join(ROOT, "edp")):
                shutil.copy(os.path.join(ROOT, "edp", idp), folder)
            return tests_notice(folder, build, log)
    finally:
        shutil.rmtree(folder)


def main():
    build, jobs, words = Build(sys.argv[1]), int(sys.argv[2]), sys.argv[3:]
    mutants = [m for m in read_list() if not words or any(w in m.path for w in words)]
    killed, explained, left, broken = 0, 0, [], []
    with ThreadPoolExecutor(jobs) as pool:
        for mutant, by in zip(mutants, pool.map(lambda m: noticed(m, build), mutants)):
            if by and (by.startswith("list.txt") or by in ("compiler", "linker")):
                broken.append(f"{by}: {mutant}")
            elif by:
                killed += 1
            elif mutant.reason:
                explained += 1
            else:
                left.append(mutant)
            print(f"{by or mutant.reason or 'NOBODY'}: {mutant}", flush=True)
    print()
    for mutant in left:
        print(f"nobody notices  {mutant}")
    for what in broken:
        print(f"no mutant  {what}")
    print(f"{len(mutants)} mutants: {killed} noticed, {explained} explained, {len(left)} left, {len(broken)} no mutants")
    sys.exit(bool(left or broken))


main()
