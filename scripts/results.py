#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/results/: every table of numbers, a page for each benchmark. See results.sh.

  results.py OTG FOLDER [--device] [--only NAME...] [--meshes FOLDER]
      runs the benchmarks of the CPU, or with --device those of an OpenCL device, and writes a page for each
  results.py OTG FOLDER --check
      runs what does not depend on the machine, in less than a minute; exit status 1 if the page there says otherwise
  results.py --same FOLDER FOLDER
      exit status 1 if pages that are in both folders differ in more than times
"""
import argparse
import datetime
import difflib
import json
import os
import pathlib
import platform
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
COUNTS = "counts"
# In this pose there are about as many candidate pairs as published.
THESIS = "--poses benchmarks/published/armadillo_poses.json --scene deep --scenes deep"
# Columns that are times or follow from them.
TIME = re.compile(r"(^|_)(ms|us|percent|seconds?|speed|ratio|times|auto|rounds|tests_per_s)(_|$)"
                  r"|_per_s|fastest|speed_up")


PUBLISHED = re.compile(r"6\.\d|figure|prefix_sums|mixtures")


class Page:
    """A page. `device`: for a GPU; `pocl`: on any device, PoCL as a rule; `meshes`: of the bodies in out/meshes;
    `figures`: drawn by the benchmark."""

    def __init__(self, name, title, about, *commands, device=False, pocl=False, meshes=False, figures=False):
        self.name, self.title, self.about, self.commands = name, title, about, [c.split() for c in commands]
        self.device, self.pocl, self.meshes, self.figures = device, pocl, meshes, figures


PAGES = [
    Page(COUNTS, "What does not depend on the machine",
         "Counts, contacts and hashes of small scenes. Continuous integration runs these commands on every machine and "
         "fails when a number differs.",
         "bench thesis --lumps 5,4,3 --repeat 1", "bench exact --pairs 50000 --judge separation --seed 1",
         "bench contours --poses 10"),
    Page("small", "Pairs of small bodies",
         "Microseconds of a dCollide between two small bodies. `ours`: both stay; the library keeps what it found for "
         "them, unless both are convex. `ours_moved`: the second body moves before each call. "
         "`any_solids`: the query by the stages for any solids.",
         "bench small --repeat 5 --poses 16 --calls 4"),
    Page("world", "Whole steps",
         "Microseconds a step, medians. `native` is made of ODE's own shapes, `stock` of dTriMesh geoms, `ours` of "
         "geoms of this library. ODE disables bodies that are asleep.", "bench world"),
    Page("terrain", "Shapes on a terrain",
         "ODE's shapes and convex meshes on an open mesh of hills, beside a dTriMesh. A shape trembles "
         "from call to call; `still`: it does not.",
         "bench terrain"),
    Page("floor", "Meshes on a floor",
         "Meshes that stand on a mesh box, on a flat sheet of 512 triangles, on a box with walls that begin in it (one mesh) and on ODE's box, "
         "beside dTriMesh geoms. "
         "They tremble from call to call; `still`: they do not.",
         "bench floor", "bench floor --overlap 0.0002", "bench floor --overlap 0.02"),
    Page("shapes", "Shapes on small and convex meshes",
         "ODE's shapes, beside a dTriMesh. A shape trembles from call to call; `still`: it does not.",
         "bench shapes --repeat 5 --poses 16 --calls 4"),
    Page("heightfield", "Meshes on a heightfield", "Microseconds of a dCollide, beside ODE's own bodies.",
         "bench heightfield"),
    Page("contacts", "Contacts against the truth",
         "Single queries against what is known by other means: normals in degrees, depths, net force and moment.",
         "bench contacts --poses 10", "bench contacts --certificate --members 100",
         "bench contacts --certificate --falls --members 100"),
    Page("physics", "Worlds that rest, slide, roll and fall",
         "Runs of the whole physics suite that keep every limit, and those that miss one.", "bench physics --full"),
    Page("exact", "Exactness",
         "Hard pairs of triangles, judged by exact arithmetic that shares nothing with the library.",
         "bench exact --pairs 1000000"),
    Page("contours", "Overlaps that could not be worked with", "Random overlaps of solids, anyhow and on a grid.",
         "bench contours --poses 60"),
    Page("primitives", "Shapes against ODE's own pairs",
         "Degrees and lengths from the same pair of ODE's shapes, and from the least way out.",
         "bench primitives --poses 200"),
    Page("tessellations", "Two meshes against the bodies that they stand for",
         "Degrees and lengths from the least way out of the bodies by formula.", "bench tessellations --poses 200"),
    Page("build", "Building, moving, scaling", "Validation, trees, moves of vertices, scaled geoms.",
         "bench build --repeat 5", meshes=True),
    Page("peers", "The whole query beside other libraries",
         "A body and its copy in a pose in which they overlap. All libraries take turns.",
         "bench peers --poses benchmarks/published/armadillo_poses.json --scene deep --repeat 15", meshes=True),
    Page("threads", "Threads", "Queries from several threads at once, and as one batch.",
         "bench threads --lumps 4 --contacts solid --pairs 512 --repeat 5"),
    Page("queries", "Points, rays, distances", "Arrays of queries by one thread and by all threads.",
         "bench queries --lumps 5 --points 10000 --rays 10000 --pairs 1000"),
    Page("thesis", "The published design",
         "The tables 6.1 to 6.5 and the figures 6.2 and 6.3 of the published work in their own form, for five sizes of "
         "one body. Ratios are compared, not times.",
         "bench thesis %s --repeat 5" % THESIS, pocl=True, meshes=True, figures=True),
    Page("thesis_device", "The published design on a GPU",
         "The tables 6.1 to 6.5 and the figures 6.2 and 6.3 of the published work in their own form, for five sizes of "
         "one body. Ratios are compared, not times.",
         "bench thesis %s --repeat 30" % THESIS, device=True, meshes=True, figures=True),
    Page("batch_device", "Batches of pairs on a GPU", "10,000 pairs in one submission, and single pairs.",
         "bench batch --contacts pairwise --lumps 6,3 --repeat 9",
         "bench batch --contacts solid --lumps 6,3 --repeat 9", device=True),
    Page("queries_device", "Points, rays, distances on a GPU",
         "Arrays of queries by one thread, by all threads, and by the device.",
         "bench queries --points 10000,1000000 --rays 10000,1000000 --pairs 1000,10000", device=True),
    Page("build_device", "What is sent of meshes that move", "Bytes that go to the device after moves.", "bench build",
         device=True, meshes=True),
]


def run(otg, command, environment):
    found = subprocess.run([otg, *command, "--json"], capture_output=True, text=True, env=environment)
    # `bench physics` ends with 3 where a run misses a limit, which its page tells.
    if found.returncode not in (0, 3):
        raise SystemExit("otg %s: exit status %d\n%s" % (" ".join(command), found.returncode, found.stderr))
    return json.loads(found.stdout)


def cell(value):
    if isinstance(value, bool) or value is None:
        return "-" if value is None else str(value).lower()
    if isinstance(value, float):
        return "%.4g" % value
    if isinstance(value, (list, dict)):
        return json.dumps(value)
    return str(value)


def columns_of(rows, with_times):
    names = []
    for row in rows:
        names += [n for n in row if n not in names]
    return [n for n in names if with_times or not TIME.search(n)]


def table(rows, with_times):
    names = columns_of(rows, with_times)
    lines = ["| %s |" % " | ".join(n.replace("_", " ") for n in names), "|%s" % ("---|" * len(names))]
    lines += ["| %s |" % " | ".join(cell(row.get(n)) for n in names) for row in rows]
    return lines


def processor():
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def commit():
    """OTG_COMMIT where there is no repository."""
    if "OTG_COMMIT" in os.environ:
        return os.environ["OTG_COMMIT"]
    try:
        found = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short=10", "HEAD"], capture_output=True, text=True)
    except OSError:
        return "unknown"
    return found.stdout.strip() or "unknown"


def measured(documents):
    devices = sorted({d["device"] for d in documents if d.get("device")})
    on = "%s, %d cores%s" % (processor(), os.cpu_count(), "".join("; OpenCL: " + d for d in devices))
    return "Measured %s at commit %s on %s." % (datetime.date.today().isoformat(), commit(), on)


def tables_of(document):
    """The tables of a benchmark; those of the physics suite are made of its runs."""
    if "tables" in document:
        return document["tables"]
    runs = [{"scene": r["scene"], "form": r["form"], "run": r["run"], "pass": r["pass"],
             "missed": ", ".join(c["measure"] for c in r["checks"] if not c["pass"]) or None} for r in document["rows"]]
    forms = sorted({r["form"] for r in runs})
    return {"passed": [{"form": f, "runs": sum(r["form"] == f for r in runs),
                        "passed": sum(r["form"] == f and r["pass"] for r in runs)} for f in forms],
            "scenes": scenes_of(document["rows"]),
            "missed": [r for r in runs if not r["pass"]]}


def scenes_of(rows):
    """All runs of a scene and a form in one line: how many, and the largest of what they measured."""
    scenes = {}
    for row in rows:
        scenes.setdefault((row["family"], row["scene"], row["form"]), []).append(row)
    lines = []
    for (family, scene, form), runs in scenes.items():
        line = {"family": family, "scene": scene, "form": form, "runs": len(runs),
                "passed": sum(r["pass"] for r in runs)}
        for measure in ("thrown", "energy_gain", "energy_rise"):
            values = [r["measures"][measure] for r in runs if measure in r["measures"]]
            line[measure] = max(values) if values else None
        lines.append(line)
    return lines


def text_of(page, otg, meshes, folder):
    environment = dict(os.environ)
    shown = ""
    if page.meshes and meshes:
        environment["OTG_MESH_DIR"] = str(meshes)
        shown = "OTG_MESH_DIR=out/meshes "
    if not page.device and not page.pocl:
        environment.setdefault("OTG_OPENCL_DEVICE", "none")
    with_times = page.name != COUNTS
    lines = ["# " + page.title, "", "Written by `scripts/results.sh`; no number here is typed by hand.", "",
             page.about, ""]
    documents, tables = [], []
    for command in page.commands:
        more = []
        if page.figures and folder is not None:
            more = ["--figures", str(folder / page.name)]
        document = run(otg, command + more, environment)
        documents.append(document)
        lines.append("    %sbuild/bin/otg %s" % (shown, " ".join(command)))
        # Those of the published work first, where there are any.
        for name, rows in sorted(tables_of(document).items(), key=lambda t: not PUBLISHED.match(t[0])):
            if not rows or (page.name == COUNTS and (name.startswith(("levels", "profile")) or PUBLISHED.match(name))):
                continue
            tables += ["", "## " + name.replace("_", " "), ""] + table(rows, with_times)
        says = ["", *document["says"]] if document.get("says") and page.name != COUNTS else []
        for figure in document.get("figures", []):
            says += ["", "![%s](%s/%s)" % (figure["title"], page.name, figure["file"])]
        tables = says + tables
    lines += ["", measured(documents) if with_times else "Holds on every machine."]
    return "\n".join(lines + tables) + "\n"


def without_times(text):
    """The page without its columns of times, its sentences about them, and the line that says where it was measured."""
    kept, drop, previous = [], [], ""
    for line in text.splitlines():
        if line.startswith("Measured ") or not line:
            continue
        if line.startswith("|"):
            cells = line.strip("|").split("|")
            if not previous.startswith("|"):
                drop = [bool(TIME.search(c.strip().replace(" ", "_"))) for c in cells]
            line = "|".join(c for c, d in zip(cells, drop, strict=False) if not d)
            previous = "|"
        else:
            previous = line
        kept.append(line)
    return [line for line in kept if not line.startswith("- ")]


def claims(otg):
    """Ratios that pages rest on, with wide bounds: what is wrong, if anything."""
    environment = dict(os.environ, OTG_OPENCL_DEVICE="none")
    rows = run(otg, "bench thesis --lumps 5 --repeat 9".split(), environment)["tables"]["combinations"]
    ms = {t: sum(r["middle_ms"] for r in rows if r["traversal"] == t and r["descent"] == "both")
          for t in ("standard", "wide")}
    tests = {t: min(r["tests_per_candidate"] for r in rows if r["traversal"] == t) for t in ("standard", "wide")}
    bad = []
    if ms["standard"] < 1.2 * ms["wide"]:
        bad.append("eight boxes at a time are not faster than one: %.3g and %.3g ms" % (ms["wide"], ms["standard"]))
    if not all(2 < t < 30 for t in tests.values()):
        bad.append("box tests for each candidate: %s" % tests)
    return bad


def differences(old, new, name):
    return list(difflib.unified_diff(old, new, name, "now", lineterm="", n=1))


def same(first, second):
    bad = 0
    for path in sorted(pathlib.Path(first).glob("*.md")):
        other = pathlib.Path(second) / path.name
        if path.name == "README.md" or not other.exists():
            continue
        found = differences(without_times(path.read_text()), without_times(other.read_text()), path.name)
        print("\n".join(found[:40]), end="\n" if found else "")
        bad += bool(found)
    return 1 if bad else 0


def write_index(folder):
    lines = ["# Results", "",
             "Every table of numbers, a page for each benchmark, written by `scripts/results.sh`. Pages say the "
             "command, the commit, the\nmachine and the date. [counts.md](counts.md) holds on every machine, which "
             "continuous integration checks.", ""]
    for page in PAGES:
        if (folder / (page.name + ".md")).exists():
            lines.append("- [%s](%s.md)" % (page.title, page.name))
    (folder / "README.md").write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("paths", nargs=2)
    parser.add_argument("--device", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--same", action="store_true")
    parser.add_argument("--only", nargs="+", default=[])
    parser.add_argument("--meshes")
    arguments = parser.parse_args()
    if arguments.same:
        return same(*arguments.paths)
    otg, folder = str(pathlib.Path(arguments.paths[0]).resolve()), pathlib.Path(arguments.paths[1])
    if arguments.check:
        page = PAGES[0]
        was = (folder / (page.name + ".md")).read_text().splitlines()
        found = differences(was, text_of(page, otg, None, None).splitlines(), "docs/results/%s.md" % page.name)
        found += claims(otg)
        print("\n".join(found))
        if found:
            print("If the change is meant: bash scripts/results.sh --only " + COUNTS)
        return 1 if found else 0
    folder.mkdir(parents=True, exist_ok=True)
    for page in PAGES:
        if page.name in arguments.only or (not arguments.only and page.device == arguments.device):
            print(page.name, flush=True)
            meshes = pathlib.Path(arguments.meshes).resolve() if arguments.meshes else None
            (folder / (page.name + ".md")).write_text(text_of(page, otg, meshes, folder))
    write_index(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
