# SPDX-License-Identifier: BSD-3-Clause
"""The page of `otg simulate --html` in a browser, from the disk: it plays, its numbers are the run's, its picture is
the one it was.

Run as: python3 test_viewer.py PATH_OF_OTG [--renew]     (--renew writes the reference picture anew; look at it)"""
import csv
import json
import os
import re
import subprocess
import sys
import tempfile

import browser

HERE = os.path.dirname(os.path.abspath(__file__))
REFERENCE = os.path.join(HERE, "reference.png")
TIME, STEP = 0.70, 140  # a frame
SCENE = {
    "steps": 280, "dt": 0.005, "planes": [{}],
    "meshes": {"torus": {"generate": "torus", "major_radius": 0.35, "minor_radius": 0.12},
               "lump": {"generate": "lump", "radius": 0.3, "level": 4, "seed": 3}},
    "bodies": [{"name": "slab", "box": [3, 3, 0.3], "collider": "gpu_trimesh", "static": True, "position": [0, 0, 0.15],
                "color": [0.2, 0.22, 0.12]},
               {"name": "torus", "mesh": "torus", "position": [-0.3, 0, 0.6], "color": [0.1, 0.3, 0.7]},
               {"name": "lump", "mesh": "lump", "position": [0.4, 0.1, 0.75], "color": [0.75, 0.2, 0.06]}]}


def main():
    otg, renew = os.path.abspath(sys.argv[1]), "--renew" in sys.argv
    if browser.find() is None:
        print("skipped: Chromium is not installed")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        def path(name):
            return os.path.join(folder, name)
        with open(path("scene.json"), "w") as file:
            json.dump(SCENE, file)
        run = subprocess.run(
            [otg, "simulate", path("scene.json"), "--html", path("run.html"), "--csv", path("run.csv")],
            capture_output=True, text=True)
        if "built without three.js" in run.stderr:
            print("skipped: otg was built without three.js")
            return 77
        assert run.returncode == 0, run.stderr
        page = "file://" + path("run.html")

        # What the page says of the time.
        dom, console = browser.visit("%s#t=%g" % (page, TIME), "--dump-dom")
        assert console == [], console
        assert 'data-state="ready"' in dom, "the page did not start"
        with open(path("run.csv")) as file:
            row = list(csv.DictReader(file))[STEP - 1]
        shown = {name: re.search(r'id="%s"[^>]*>([^<]*)<' % name, dom).group(1)
                 for name in ("contacts_now", "energy_now", "clock")}
        assert shown["clock"] == "0.70 of 1.40 s", shown
        assert shown["contacts_now"] == row["contacts"] and int(row["contacts"]) > 2, (shown, row)
        total = float(row["kinetic_energy"]) + float(row["potential_energy"])
        assert abs(float(shown["energy_now"].split()[1]) / total - 1) < 1e-3, (shown, total)

        # Without #t it plays by itself.
        dom, console = browser.visit(page, "--dump-dom")
        assert console == [] and float(re.search('id="clock">([0-9.]+) of 1.40 s', dom).group(1)) > 0.05

        # What it shows.
        picture = path("now.png")
        assert browser.screenshot("%s#t=%g" % (page, TIME), picture) == []
        now = browser.read_png(picture)
        if renew:
            with open(picture, "rb") as source, open(REFERENCE, "wb") as target:
                target.write(source.read())
            print("written: " + REFERENCE)
            return 0
        reference = browser.read_png(REFERENCE)
        share, mean = browser.difference(now, reference)
        print("against the reference: %.2f %% of squares differ, %.2f of 255 on average" % (100 * share, mean))
        assert share < 0.02 and mean < 2, "the page looks different; if it is meant to, run with --renew and look"

        # The measure sees what matters: another time, and a page that shows nothing.
        assert browser.screenshot("%s#t=0" % page, picture) == []
        earlier, _ = browser.difference(browser.read_png(picture), reference)
        assert earlier > 0.02, earlier
        blank = (now[0], now[1], [bytes([244, 245, 247]) * now[0]] * now[1])
        assert browser.difference(blank, reference)[0] > 0.3
    print("ok")
    return 0


if __name__ == "__main__":
    sys.exit(main())
