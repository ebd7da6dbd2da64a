# SPDX-License-Identifier: BSD-3-Clause
"""otg simulate --html: one page that loads nothing, and data in it that are those of the run."""
import base64
import csv
import html
import itertools
import json
import re
import struct
import subprocess
import sys
import tempfile

import cli_support
from cli_support import CliTest

SCENE = {"steps": 70, "dt": 0.005, "planes": [{"offset": -1}],
         "meshes": {"lump": {"generate": "lump", "radius": 0.3, "level": 2}},
         "bodies": [{"name": "ground", "box": [4, 4, 1], "collider": "gpu_trimesh", "static": True,
                     "position": [0, 0, -0.5]},
                    {"name": "lump", "mesh": "lump", "position": [0.1, 0, 0.4], "color": [0.1, 0.2, 0.3]},
                    {"name": "</script><!-- %RUN% & \u00e9", "mesh": "lump", "position": [1, 0, 0.6],
                     "angular_velocity": [1, 2, 3]}]}
STEPS_PER_FRAME = 7


def numbers(text, kind):
    data = base64.b64decode(text, validate=True)
    return struct.unpack("<%d%s" % (len(data) // struct.calcsize(kind), kind), data)


class Page(CliTest):
    def page_of(self, scene, *options):
        path = self.write("%TITLE% <b>.json", json.dumps(scene))
        document = self.run_json("simulate", path, "--html", "run.html", "--csv", "run.csv", *options)
        with open(self.path("run.html"), encoding="utf-8") as file:
            page = file.read()
        scripts = re.findall(r"<script([^>]*)>(.*?)</script>", page, re.S)
        runs = [json.loads(text) for attributes, text in scripts if 'id="run"' in attributes]
        self.assertEqual((len(runs), len(scripts)), (1, 4))
        return page, runs[0], document

    def test_nothing_is_loaded(self):
        page, run, _ = self.page_of(SCENE)
        own = re.sub(r"<script.*?</script>", "", page, flags=re.S)
        self.assertIsNone(re.search(r"""(src|href)\s*=|@import|url\(""", own))
        self.assertEqual(html.unescape(re.search("<title>(.*?)</title>", page).group(1)), "%TITLE% <b>.json")
        self.assertEqual(run["title"], "%TITLE% <b>.json")
        self.assertIn("Permission is hereby granted, free of charge", own)  # three.js is inside

    def test_poses_and_series(self):
        _, run, document = self.page_of(SCENE)
        self.assertEqual((run["format"], run["version"]), ("ode_trimesh_gpu run", 1))
        self.assertEqual((run["dt"], run["steps_per_frame"], run["frames"]), (0.005, STEPS_PER_FRAME, 11))
        self.assertEqual([body["name"] for body in run["bodies"]], [body["name"] for body in SCENE["bodies"]])
        self.assertEqual([body["poses"] for body in run["bodies"]], [1, 11, 11])
        self.assertEqual(run["bodies"][1]["surface"], run["bodies"][2]["surface"])
        self.assertEqual(run["bodies"][1]["color"], [0.1, 0.2, 0.3])
        self.assertEqual(run["planes"], [{"normal": [0, 0, 1], "offset": -1}])
        # Step 70 is the last frame.
        for body, state in zip(run["bodies"], document["bodies"], strict=True):
            positions, rotations = numbers(body["positions"], "f"), numbers(body["rotations"], "h")
            self.assertEqual((len(positions), len(rotations)), (3 * body["poses"], 4 * body["poses"]))
            for got, expected in zip(positions[-3:], state["position"], strict=True):
                self.assertAlmostEqual(got, expected, delta=1e-6)
            for got, expected in zip(rotations[-4:], state["rotation"], strict=True):
                self.assertAlmostEqual(got / 32767, expected, delta=2e-5)
        self.assertEqual(list(numbers(run["steps"]["contacts"], "I")), document["contacts_per_step"])
        with open(self.path("run.csv")) as file:
            rows = list(csv.DictReader(file))
        for key in ("kinetic", "potential"):
            series = numbers(run["steps"][key], "f")
            self.assertEqual(len(series), 70)
            for got, row in zip(series, rows, strict=True):
                self.assertAlmostEqual(got, float(row[key + "_energy"]), delta=1e-6 * max(1, abs(got)))

    def test_surfaces(self):
        _, run, _ = self.page_of(SCENE)
        triangles = []
        for surface in run["surfaces"]:
            positions = numbers(surface["positions"], "H")
            indices = numbers(surface["indices"], "H" if surface["index_bits"] == 16 else "I")
            self.assertEqual(len(positions), 3 * surface["vertices"])
            self.assertEqual(len(numbers(surface["normals"], "b")), 3 * surface["vertices"])
            self.assertEqual(len(indices), 3 * surface["triangles"])
            self.assertLess(max(indices), surface["vertices"])
            triangles.append(surface["triangles"])
        self.assertEqual(triangles, [12, 320])
        # The box's corners are where they were.
        box = run["surfaces"][0]
        points = numbers(box["positions"], "H")
        for axis, half in enumerate((2, 2, 0.5)):
            values = [box["low"][axis] + box["step"] * points[i] for i in range(axis, len(points), 3)]
            self.assertAlmostEqual(min(values), -half, delta=1e-4)
            self.assertAlmostEqual(max(values), half, delta=1e-4)

    def test_contacts(self):
        """A ball on a plane: one contact below its middle, that points up, as deep as the ball is below the plane."""
        ball = {"steps": 42, "planes": [{}], "bodies": [
            {"name": "ball", "sphere": 0.5, "position": [1, 2, 0.49]}]}
        _, run, document = self.page_of(ball)
        contacts = run["contacts"]
        starts = numbers(contacts["starts"], "I")
        counts = [b - a for a, b in itertools.pairwise(starts)]
        self.assertEqual(counts, [0] + document["contacts_per_step"][STEPS_PER_FRAME - 1::STEPS_PER_FRAME])
        self.assertEqual(starts[-1], contacts["count"])
        self.assertEqual(counts[1], 1)
        low, step = numbers(contacts["low"], "f"), numbers(contacts["step"], "f")
        positions, directions = numbers(contacts["positions"], "H"), numbers(contacts["directions"], "b")
        depths = numbers(contacts["depths"], "H")
        place = [low[3 + axis] + step[1] * positions[axis] for axis in range(3)]
        self.assertAlmostEqual(place[0], 1, delta=1e-3)
        self.assertAlmostEqual(place[1], 2, delta=1e-3)
        self.assertEqual(directions[:3], (0, 0, 127))  # into the ball, whichever geom was first
        depth = depths[0] * contacts["depth_step"]
        self.assertTrue(0 < depth <= 0.0101, depth)
        self.assertLessEqual(contacts["usual_depth"], max(depths) * contacts["depth_step"] * 1.0001)

    def test_nothing_moves_and_nothing_touches(self):
        for scene in ({"steps": 3, "bodies": [{"name": "a", "sphere": 1, "static": True}]},
                      {"steps": 0, "bodies": []}):
            _, run, _ = self.page_of(scene)
            self.assertEqual(run["frames"], 1)
            self.assertEqual(run["contacts"]["count"], 0)

    def test_a_page_that_cannot_be_written(self):
        path = self.write("scene.json", json.dumps({"steps": 1, "bodies": []}))
        self.assert_fails(1, "simulate", path, "--html", "/nowhere/run.html", says="/nowhere/run.html")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        with open(folder + "/empty.json", "w") as file:
            file.write('{"steps": 0, "bodies": []}')
        probe = subprocess.run([sys.argv[1], "simulate", folder + "/empty.json", "--html", folder + "/page.html"],
                               capture_output=True, text=True)
    if "built without three.js" in probe.stderr:
        print("skipped: otg was built without three.js")
        sys.exit(77)
    cli_support.main()
