#!/usr/bin/env python3
"""One-line faults put into plugin/ and edp/, one at a time: each must be noticed by a test.

  run.py BUILD JOBS [word ...]     only the mutants of files whose path has one of the words

list.txt holds them:

  @ core/gradient/line_search.cpp      the file, below plugin/; or edp/frictionCGmap.idp
  ! laws.edp errors.edp                scripts that are tried first: of plugin/freefem and edp/, which have no unit tests
  - text                               stands once in the file
  + text                               what stands there instead
  ? reason                             only where no test can notice: the same answers, other costs

The unit tests are tried first, those of the file's own folder, the other quick ones, the long ones, and then the
scripts; without a fault all of them must pass. Faults in plugin/mpi are tried by the scripts of several processes, where
BUILD has frictionCG-mpi.so; elsewhere they are passed over. Faults in plugin/freefem and edp/ are tried by the scripts
named, one by one, and then by all others. Faults with a reason are tried only with EXPLAINED=1. BUILD holds the objects and the plugin of a build at -O1, and unit_tests. Prints a line each, and those
that nothing noticed again at the end.
"""
import functools
import glob
import hashlib
import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
LONG = ":".join(["RandomScenes.*", "*200RandomScenes*", "Hierarchy.*", "Faults.*", "*LargeFriction*", "Arrival*",
                 "Held.*", "MortarSearch.Steps*", "MortarPatch.*", "MortarContact.*", "MortarPartlyCovered.Uniform*",
                 "MortarGap.*", "Multigrid*"])
SHARED = "frictionCG-mpi.so"
SECONDS = 300  # a fault that makes a test run for ever is noticed, too


class Mutant:
    def __init__(self, path, old, new, line, judges):
        self.path, self.old, self.new, self.line, self.judges = path, old, new, line, judges
        self.reason = None

    def source(self):
        return self.path if self.path.startswith("edp/") else f"plugin/{self.path}"

    def __str__(self):
        return f"{self.path}: {self.old.strip()}  ->  {self.new.strip()}"


def read_list():
    mutants, path, old, judges = [], None, None, []
    with open(os.path.join(HERE, "list.txt")) as f:
        for number, line in enumerate(f, 1):
            mark, text = line[:2], line[2:].rstrip("\n")
            if mark == "@ ":
                path, judges = text.strip(), []
            elif mark == "! ":
                judges = text.split()
            elif mark == "- ":
                old = text
            elif mark in ("+ ", "+\n"):
                mutants.append(Mutant(path, old, text, number, judges))
            elif mark == "? ":
                mutants[-1].reason = text
    return mutants


def misplaced(mutant):
    """In words, where the text does not stand once in the file."""
    with open(os.path.join(ROOT, mutant.source())) as f:
        count = f.read().count(mutant.old)
    return "" if count == 1 else f"list.txt:{mutant.line}: stands {count} times, and not once, in {mutant.path}"


def fault(command, log, seconds=None, **more):
    """What is wrong with a command: nothing where it ends well in time."""
    try:
        ended = subprocess.run(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, timeout=seconds, **more)
        return "failed" if ended.returncode else ""
    except subprocess.TimeoutExpired:
        return f"ran longer than {seconds} s"


@functools.lru_cache(None)
def included(path):
    """A file of plugin/ or tests/unit and all of our own headers in it, below ROOT."""
    files = {path}
    with open(os.path.join(ROOT, path)) as f:
        for name in re.findall(r'^#include "(.*)"', f.read(), re.M):
            for folder in (os.path.dirname(path), "plugin/core", "plugin", "tests"):
                header = os.path.normpath(os.path.join(folder, name))
                if os.path.exists(os.path.join(ROOT, header)):
                    files |= included(header)
                    break
    return files


class Build:
    """How make builds the plugin and its tests: its own commands, with one object exchanged."""

    def __init__(self, build):
        self.build = build
        self.lines = {}
        self.shared = os.path.exists(os.path.join(ROOT, build, SHARED))
        for target in ["unit_tests", "frictionCG.so"] + [SHARED] * self.shared:
            out = subprocess.run(["make", "-n", "-B", f"BUILD={build}", "TOGETHER=1", "CXXFLAGS=-O1",
                                  f"{build}/{target}"],
                                 cwd=ROOT, capture_output=True, text=True, check=True).stdout
            for line in out.replace("\\\n", " ").splitlines():
                made = re.search(r" -o (\S+)", line)
                if made:
                    self.lines[made.group(1)] = line

    def objects(self, path, room, sources):
        """The objects of build/room, from such sources, that a file of plugin/core goes into."""
        made = [o for o in self.lines if o.startswith(f"{self.build}/{room}/") and o.endswith(".o")]
        return [o for o in made if f"plugin/{path}" in included(sources + o[len(f"{self.build}/{room}"):-2] + ".cpp")]

    def adapters(self, path):
        """The objects of the sequential plugin that a file of plugin/freefem goes into."""
        goes = f"plugin/{path}" in included("plugin/frictionCG.cpp")
        return self.objects(path, "freefem", "plugin/freefem") + [f"{self.build}/frictionCG.o"] * goes

    def command(self, target, exchange):
        line = self.lines[f"{self.build}/{target}" if "/" not in target else target]
        for old, new in exchange.items():
            line = re.sub(r"(?<=\s)" + re.escape(old) + r"(?=\s|$)", new, line)
        return line


@functools.lru_cache(None)
def suites(room):
    """The unit tests of one folder, as a filter; every name of a folder's path counts."""
    names = set()
    for folder, _, files in os.walk(os.path.join(ROOT, "tests/unit")):
        if os.path.basename(folder) == room:
            for name in files:
                with open(os.path.join(folder, name)) as f:
                    names.update(re.findall(r"^TEST\((\w+),", f.read(), re.M))
    return ":".join(sorted(f"{name}.*" for name in names))


def unit_tests_notice(folder, log, path=""):
    own = suites(os.path.basename(os.path.dirname(path)))
    filters = [f"{own}-{LONG}", f"-{LONG}:{own}"] if own else [f"-{LONG}"]
    unit = os.path.join(folder, "unit_tests")
    faults = (fault([unit, f"--gtest_filter={tests}", "--gtest_fail_fast"], log, SECONDS, cwd=folder)
              for tests in filters + [LONG])
    return next(filter(None, faults), "")


def scripts_notice(folder, log, room="edp", judges=()):
    env = dict(os.environ, BUILD=os.path.relpath(folder, ROOT))
    plugins = os.environ.get("FF_PLUGINS", "/usr/lib/freefem++")
    idp = os.environ.get("FF_IDP", "/usr/include/freefem++/idp")
    env["FF_LOADPATH"] = f"{folder};{plugins}"
    env["FF_INCLUDEPATH"] = f"{folder};{os.path.join(ROOT, 'tests')};{idp}"  # scripts include ../tests/edp
    scripts = sorted(s for s in os.listdir(os.path.join(ROOT, "tests", room)) if s.endswith(".edp"))
    others = [s for s in scripts if s not in judges]
    faults = (fault(["bash", "tests/run"] + [f"tests/{room}/{s}" for s in some], log, 2 * SECONDS, cwd=ROOT, env=env)
              for some in [[judge] for judge in judges] + [others])
    return next(filter(None, faults), "")


def noticed(mutant, build):
    """Who notices the fault, or None."""
    if mutant.reason and not os.environ.get("EXPLAINED"):
        return None
    source = os.path.join(ROOT, mutant.source())
    with open(source) as f:
        text = f.read()
    # the same folder for the same fault: a compiler cache knows it again
    folder = os.path.join(ROOT, build.build, "mutant" + hashlib.sha1(str(mutant).encode()).hexdigest()[:12])
    shutil.rmtree(folder, ignore_errors=True)
    os.mkdir(folder)
    try:
        with open(os.path.join(folder, "log"), "w") as log:
            # the fault in a copy of the core, found before the true one
            copy = os.path.join(folder, "plugin")
            shutil.copytree(os.path.join(ROOT, "plugin"), copy)
            if not mutant.path.startswith("edp/"):
                with open(os.path.join(copy, mutant.path), "w") as f:
                    f.write(text.replace(mutant.old, mutant.new))
            exchange = {}

            def compiled(room, sources):
                return all_made(build.objects(mutant.path, room, sources))

            def all_made(objects):
                for made in objects:
                    name = os.path.join(folder, f"{len(exchange)}.o")
                    command = build.command(made, {made: name})
                    command = re.sub(r"(?<=[ I])plugin(?=[/ ])", copy, command)
                    if fault(command, log, shell=True, cwd=ROOT):
                        return False
                    exchange[made] = name
                return True

            def linked(target):
                for idp in glob.glob(os.path.join(ROOT, "edp", "*.idp")):
                    shutil.copy(idp, folder)
                made = {f"{build.build}/{target}": os.path.join(folder, target), **exchange}
                return not fault(build.command(target, made), log, shell=True, cwd=ROOT)

            if mutant.path.startswith("edp/"):
                shutil.copy(os.path.join(ROOT, build.build, "frictionCG.so"), folder)
                for idp in glob.glob(os.path.join(ROOT, "edp", "*.idp")):
                    shutil.copy(idp, folder)
                with open(os.path.join(folder, os.path.basename(mutant.path)), "w") as f:
                    f.write(text.replace(mutant.old, mutant.new))
                seen = scripts_notice(folder, log, judges=mutant.judges)
                return seen and f"scripts {seen}"
            if mutant.path.startswith("freefem/"):
                if not all_made(build.adapters(mutant.path)):
                    return "compiler"
                if not linked("frictionCG.so"):
                    return "linker"
                seen = scripts_notice(folder, log, judges=mutant.judges)
                return seen and f"scripts {seen}"
            if mutant.path.startswith("mpi/"):
                if not compiled("distributed", "plugin/mpi"):
                    return "compiler"
                if not linked(SHARED) or not linked("frictionCG.so"):
                    return "linker"
                seen = scripts_notice(folder, log, "mpi")
                return seen and f"scripts of several processes {seen}"

            # a test may have compiled a header's function into itself
            rooms = [("core", "plugin/core")] + [("unit", "tests/unit")] * mutant.path.endswith(".h")
            for room, sources in rooms:
                if not compiled(room, sources):
                    return "compiler"
                if not linked("unit_tests"):
                    return "linker"
                seen = unit_tests_notice(folder, log, mutant.path)
                if seen:
                    return f"unit tests {seen}"
            if not linked("frictionCG.so"):
                return "linker"
            seen = scripts_notice(folder, log)
            if seen:
                return f"scripts {seen}"
            return None
    finally:
        shutil.rmtree(folder)


def main():
    build, jobs, words = Build(sys.argv[1]), int(sys.argv[2]), sys.argv[3:]
    wrong = list(filter(None, map(misplaced, read_list())))
    if wrong:
        sys.exit("\n".join(wrong))
    with open(os.path.join(build.build, "mutants.log"), "w") as log:
        folder = os.path.join(ROOT, build.build)
        if unit_tests_notice(folder, log) or scripts_notice(folder, log) or (
                build.shared and scripts_notice(folder, log, "mpi")):
            sys.exit(f"tests fail without a fault: {log.name}")
    mutants = [m for m in read_list() if not words or any(w in m.path for w in words)]
    mutants = [m for m in mutants if build.shared or not m.path.startswith("mpi/")]
    killed, explained, left, broken = 0, 0, [], []
    with ThreadPoolExecutor(jobs) as pool:
        for mutant, by in zip(mutants, pool.map(lambda m: noticed(m, build), mutants)):
            if by in ("compiler", "linker"):
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


if __name__ == "__main__":
    main()
