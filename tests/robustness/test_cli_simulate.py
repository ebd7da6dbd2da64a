# SPDX-License-Identifier: BSD-3-Clause
"""otg simulate: results, files, determinism, the examples of the manual, and every kind of bad scene."""
import csv
import itertools
import json
import math
import os
import re
import struct

import cli_support
from cli_support import CliTest, box, ply

DROP = {"steps": 60, "meshes": {"ground": {"generate": "ground", "size": 4, "thickness": 0.5, "divisions": 4},
                                "lump": {"generate": "lump", "radius": 0.3, "level": 2}},
        "bodies": [{"name": "ground", "mesh": "ground", "static": True},
                   {"name": "lump", "mesh": "lump", "position": [0.1, 0, 0.4]}]}


class Simulate(CliTest):
    def scene(self, content, name="scene.json"):
        return self.write(name, json.dumps(content))

    def test_keys(self):
        document = self.run_json("simulate", self.scene(DROP))
        self.assert_keys(document, "steps contacts_per_step step_ms collide_ms bodies hash energy")
        self.assertEqual(document["steps"], 60)
        self.assertEqual(len(document["contacts_per_step"]), 60)
        self.assertGreater(max(document["contacts_per_step"]), 0)
        self.assertEqual([body["name"] for body in document["bodies"]], ["ground", "lump"])
        for body in document["bodies"]:
            self.assert_keys(body, "name position rotation linear_velocity")
        self.assertEqual(document["bodies"][0]["position"], [0, 0, 0])
        self.assertIn("lump", self.run_otg("simulate", self.scene(DROP)).stdout)

    def test_prefetch_changes_nothing_but_the_time(self):
        scene = {**DROP, "bodies": DROP["bodies"] + [
            {"name": f"lump {i}", "mesh": "lump", "position": [0.2 * i, 0.1, 0.7 + 0.3 * i]} for i in range(4)]}
        path = self.scene(scene)
        plain = self.run_json("simulate", path)
        runs = [["--prefetch"], ["--prefetch", "--threads", "3"], ["--backend", "auto"]]
        if self.run_json("devices")["used"] is not None:
            runs += [["--backend", "opencl"], ["--backend", "opencl", "--prefetch"]]
        for options in runs:
            document = self.run_json("simulate", path, *options)
            self.assertEqual(document["hash"], plain["hash"], options)
            if "opencl" in options:
                self.assertEqual(document["backend"], "opencl", options)
        # Without a device the CPU does it all, and says so.
        nothing = self.run_otg("simulate", path, "--backend", "opencl", "--json", env={"OTG_OPENCL_DEVICE": "none"})
        document = json.loads(nothing.stdout)
        self.assertEqual((document["hash"], document["backend"]), (plain["hash"], plain["backend"]))
        self.assertEqual(document["backend"], "cpu")
        self.assertEqual(nothing.stderr.count("no OpenCL device"), 1, nothing.stderr)

    def test_free_fall(self):
        """Symplectic Euler by hand; the mesh's centre of mass is off its origin, which must make no difference."""
        self.write("off.ply", ply(*box(center=(3, 0, 0))))
        scene = {"dt": 0.01, "gravity": [0, 0, -10], "meshes": {"m": {"file": "off.ply"}},
                 "bodies": [{"name": "a", "mesh": "m", "position": [1, 2, 30], "linear_velocity": [2, 0, 0]},
                            {"name": "b", "sphere": 0.5, "position": [50, 0, 0], "collider": "gpu_trimesh"}]}
        document = self.run_json("simulate", self.scene(scene), "--steps", "100")
        z, speed = 0.0, 0.0
        for _ in range(100):
            speed -= 10 * 0.01
            z += speed * 0.01
        for body, start in zip(document["bodies"], ([1, 2, 30], [50, 0, 0]), strict=True):
            self.assertAlmostEqual(body["position"][2], start[2] + z, places=9)
            self.assertAlmostEqual(body["linear_velocity"][2], speed, places=9)
        self.assertAlmostEqual(document["bodies"][0]["position"][0], 1 + 2, places=9)
        self.assertAlmostEqual(document["bodies"][0]["center_of_mass"][0], 1 + 2 + 3, places=6)

    def test_a_box_rests_where_it_lies(self):
        for collider in ("gpu_trimesh", "primitive"):
            scene = {"steps": 200, "bodies": [
                {"name": "ground", "box": [4, 4, 1], "collider": collider, "static": True, "position": [0, 0, -0.5]},
                {"name": "box", "box": [1, 1, 1], "collider": collider, "position": [0.1, 0.2, 0.5]}]}
            body = self.run_json("simulate", self.scene(scene))["bodies"][1]
            for got, expected in zip(body["position"], (0.1, 0.2, 0.5), strict=True):
                self.assertLess(abs(got - expected), 0.02, collider)

    def test_over_the_rim_of_a_sheet(self):
        """The curve in which a body crosses a sheet does not close there, and contacts come from pairs of triangles: a
        box rests where ODE's own box rests and falls where that falls, whatever the tessellation."""
        for n in (1, 8, 40):
            corners = [(2 * i / n - 1, 2 * j / n - 1, 0) for j in range(n + 1) for i in range(n + 1)]
            faces = []
            for j in range(n):
                for i in range(n):
                    a = j * (n + 1) + i
                    faces += [(a, a + 1, a + n + 2), (a, a + n + 2, a + n + 1)]
            self.write("sheet.ply", ply(corners, faces))
            for x in (0.8, 0.9, 0.97, 1.03, 1.1):
                scene = {"steps": 600, "space": "simple", "meshes": {"sheet": {"file": "sheet.ply"}}, "bodies": [
                    {"name": "sheet", "mesh": "sheet", "static": True},
                    {"name": "box", "box": [0.5, 0.5, 0.5], "collider": "gpu_trimesh", "mass": 1,
                     "position": [x, 0.13, 0.2502]}]}
                got = self.run_json("simulate", self.scene(scene))["bodies"][1]["position"]
                if x > 1:
                    self.assertLess(got[2], -1, (n, x))
                    continue
                for value, expected in zip(got, (x, 0.13, 0.25), strict=True):
                    self.assertLess(abs(value - expected), 5e-3, (n, x, got))

    def test_a_ball_of_facets_rolls_as_a_sphere_the_finer_they_are(self):
        """A polygon of n sides that rolls without bouncing loses a share of its speed with each side, and with each
        turn one that falls as 1/n: the ball loses no more than that, and half as much where the facets are half as
        long."""
        speed, radius, steps = 3.0, 0.4, 960
        lost = []
        for level in (3, 4, 5):
            document = self.run_json("simulate", self.scene({
                "steps": steps, "dt": 1 / steps, "stepper": "world", "mu": 0.7, "planes": [{}], "bodies": [
                    {"name": "ball", "sphere": radius, "collider": "gpu_trimesh", "level": level, "mass": 1,
                     "position": [0, 0, radius], "linear_velocity": [speed, 0, 0],
                     "angular_velocity": [0, speed / radius, 0]}]}))
            ball = document["bodies"][0]
            sides = 5 * 2 ** level
            # Each side takes 1 - (5/7)(1 - cos(2 pi / n)) of the speed; there are n way / (2 pi r) of them.
            way = ball["position"][0]
            least = speed * (1 - 5 / 7 * (1 - math.cos(2 * math.pi / sides))) ** (sides * way / (2 * math.pi * radius))
            self.assertGreater(ball["linear_velocity"][0], least, level)
            self.assertLess(abs(ball["position"][1]), 0.01)
            lost.append(speed - way)
        for coarse, fine in itertools.pairwise(lost):
            self.assertLess(fine, 0.7 * coarse, lost)
        self.assertLess(lost[-1], 0.03 * speed, lost)

    def test_same_scene_same_bytes(self):
        hashes = {self.run_json("simulate", self.scene(DROP))["hash"] for _ in range(2)}
        self.assertEqual(len(hashes), 1)
        self.assertNotIn(self.run_json("simulate", self.scene(DROP), "--dt", "0.004")["hash"], hashes)
        self.assertNotIn(self.run_json("simulate", self.scene({**DROP, "seed": 3}))["hash"], hashes)

    def test_contacts_per_region_and_history(self):
        rest = {**DROP, "bodies": [DROP["bodies"][0], {"name": "box", "box": [0.5, 0.5, 0.5], "collider": "gpu_trimesh",
                                                       "position": [0.1, 0, 0.249]}]}
        scene = self.scene(rest)
        few = self.run_json("simulate", scene, "--contacts-per-region", "2")
        self.assertEqual(max(few["contacts_per_step"]), 2)
        self.assertGreaterEqual(max(self.run_json("simulate", scene)["contacts_per_step"]), 4)
        self.assertEqual(few["hash"], self.run_json("simulate", self.scene({**rest, "contacts_per_region": 2}))["hash"])
        self.assertEqual(self.run_json("simulate", scene, "--region-merge", "0")["hash"],
                         self.run_json("simulate", scene)["hash"])
        # A box deep inside a larger one finds its way out, by the way it began or by the shortest of the moment.
        inside = {"steps": 40, "gravity": [0, 0, 0], "bodies": [
            {"name": "large", "box": [2, 2, 2], "collider": "gpu_trimesh", "static": True},
            {"name": "small", "box": [0.5, 0.5, 0.5], "collider": "gpu_trimesh", "position": [0.02, 0.01, 0],
             "linear_velocity": [-1, 0.5, 0], "angular_velocity": [0, 0, 5]}]}
        path = self.scene(inside)
        without = self.run_json("simulate", path, "--no-history")["hash"]
        self.assertNotEqual(self.run_json("simulate", path)["hash"], without)
        self.assertEqual(self.run_json("simulate", self.scene({**inside, "history": False}))["hash"], without)

    def test_csv(self):
        document = self.run_json("simulate", self.scene(DROP), "--csv", "out.csv", "--steps", "40")
        with open(self.path("out.csv")) as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 40)
        self.assertEqual([int(row["contacts"]) for row in rows], document["contacts_per_step"])
        self.assert_keys(rows[0], "step time contacts contacts_before_reduction collide_ms step_ms")
        # Contacts on a surface may need no pairs of triangles; without contacts nothing intersects here.
        for row in rows:
            self.assertTrue(int(row["contacts"]) > 0 or int(row["intersecting_pairs"]) == 0, row)
        self.assertTrue(any(int(row["contacts"]) > 0 for row in rows))

    def test_glb(self):
        document = self.run_json("simulate", self.scene(DROP), "--glb", "out.glb")
        with open(self.path("out.glb"), "rb") as file:
            data = file.read()
        magic, version, length = struct.unpack_from("<III", data)
        self.assertEqual((magic, version, length), (0x46546C67, 2, len(data)))
        size, kind = struct.unpack_from("<II", data, 12)
        self.assertEqual(kind, 0x4E4F534A)
        gltf = json.loads(data[20:20 + size])
        binary = data[20 + size + 8:]
        nodes = {node["name"]: i for i, node in enumerate(gltf["nodes"])}
        arrows = {name for name in nodes if re.fullmatch(r"contact [0-4]", name)}
        self.assertEqual(set(nodes) - arrows, {"world", "ground", "lump", "camera", "sun", "sky"})
        channels = {(c["target"]["node"], c["target"]["path"]): gltf["animations"][0]["samplers"][c["sampler"]]
                    for c in gltf["animations"][0]["channels"]}
        moving = [i for i, node in enumerate(gltf["nodes"]) if node["name"] == "lump" or node["name"] in arrows]
        self.assertEqual(set(channels), {(i, path) for i in moving for path in ("translation", "rotation", "scale")
                                         if path != "scale" or i != nodes["lump"]})
        times = gltf["accessors"][channels[nodes["lump"], "translation"]["input"]]
        self.assertAlmostEqual(times["max"][0], 60 * 0.005 - 60 * 0.005 % 0.035, places=5)
        track = gltf["accessors"][channels[nodes["lump"], "translation"]["output"]]
        self.assertEqual(track["count"], times["count"])
        view = gltf["bufferViews"][track["bufferView"]]
        self.assertEqual([round(x, 6) for x in struct.unpack_from("<3f", binary, view.get("byteOffset", 0))],
                         [0.1, 0, 0.4])
        self.assertLess(document["bodies"][1]["position"][2], 0.4)
        # In each frame as many arrows are drawn as its step had contacts.
        every = 7
        drawn = [0] * times["count"]
        for i in moving:
            if i == nodes["lump"]:
                continue
            sampler = channels[i, "scale"]
            self.assertEqual(sampler["interpolation"], "STEP")
            view = gltf["bufferViews"][gltf["accessors"][sampler["output"]]["bufferView"]]
            scales = struct.unpack_from("<%df" % (3 * len(drawn)), binary, view.get("byteOffset", 0))
            for frame in range(len(drawn)):
                drawn[frame] += scales[3 * frame] > 0
        self.assertEqual(drawn[1:], document["contacts_per_step"][every - 1::every])
        self.assertGreater(max(drawn), 0)
        # A camera and lights.
        self.assertEqual(gltf["cameras"][gltf["nodes"][nodes["camera"]]["camera"]]["type"], "perspective")
        lights = gltf["extensions"]["KHR_lights_punctual"]["lights"]
        for name in ("sun", "sky"):
            light = lights[gltf["nodes"][nodes[name]]["extensions"]["KHR_lights_punctual"]["light"]]
            self.assertEqual((light["name"], light["type"]), (name, "directional"))
        self.assertIn("KHR_lights_punctual", gltf["extensionsUsed"])
        # What was written is a mesh that can be read again.
        row = self.run_json("check", self.path("out.glb"))
        self.assertTrue(row["closed"])

    def test_meshes_touch_primitives_and_planes(self):
        """A mesh on a plane, each primitive on that mesh, and a mesh on a primitive: all rest where they were put."""
        bodies = [{"name": "slab", "box": [4, 4, 0.4], "collider": "gpu_trimesh", "divisions": 8, "mass": 20,
                   "position": [0, 0, 0.2]}]
        shapes = [{"box": [0.4, 0.4, 0.4]}, {"sphere": 0.2}, {"cylinder": [0.2, 0.4]},
                  {"capsule": [0.2, 0.5], "rotation": [0.7071067811865476, 0.7071067811865476, 0, 0]}]
        for i, shape in enumerate(shapes):
            bodies.append({"name": "on%d" % i, "position": [i - 1.5, 0, 0.6], "mass": 1, **shape})
        bodies.append({"name": "stock", "box": [0.4, 0.4, 0.4], "collider": "ode_trimesh", "mass": 1,
                       "position": [1.5, 1, 0.6]})
        bodies.append({"name": "top", "box": [0.3, 0.3, 0.2], "collider": "gpu_trimesh", "mass": 1,
                       "position": [-1.5, 0, 0.9]})
        document = self.run_json("simulate", self.scene({"steps": 200, "planes": [{}], "bodies": bodies}))
        for before, after in zip(bodies, document["bodies"], strict=True):
            for x, y in zip(before["position"], after["position"], strict=True):
                self.assertAlmostEqual(x, y, delta=1e-3, msg=before["name"])

    def test_examples_of_the_manual(self):
        manual = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs", "scene_format.md")
        with open(manual) as file:
            examples = re.findall(r"```json\n(.*?)```", file.read(), re.DOTALL)
        self.assertGreaterEqual(len(examples), 6)
        self.writeBox("part.ply", center=(500, 0, 0), size=(1000, 1000, 1000))
        for number, example in enumerate(examples):
            document = self.run_json("simulate", self.write("example%d.json" % number, example))
            self.assertGreater(document["steps"], 0)
            for body in document["bodies"]:
                self.assertTrue(all(abs(x) < 100 for x in body["position"]), (number, body))


class BadScenes(CliTest):
    def refuse(self, content, *says):
        text = content if isinstance(content, str) else json.dumps(content)
        self.assert_fails(1, "simulate", self.write("bad.json", text), says=["bad.json", *says])

    def body(self, **keys):
        return {"bodies": [{"name": "a", "sphere": 1, **keys}]}

    def test_files(self):
        self.assert_fails(1, "simulate", "missing.json", says="missing.json")
        self.assert_fails(1, "simulate", self.folder, says=self.folder)
        self.refuse("", "JSON")
        self.refuse("not json at all", "JSON")
        self.refuse("{\"bodies\": [", "JSON")
        self.refuse("[]", "object")

    def test_a_misspelt_key_names_the_one_that_was_meant(self):
        self.refuse({"bodies": [], "gravty": [0, 0, -9]}, "gravty", "did you mean 'gravity'")
        self.refuse(self.body(frction=1), "bodies[0]")
        self.refuse(self.body(colro=[1, 1, 1]), "bodies[0]", "did you mean 'color'")
        # Also where it is a key that must be there.
        self.refuse({"bodys": []}, "'bodies'", "did you mean it by 'bodys'")

    def test_unknown_keys(self):
        self.refuse({"bodies": [], "gravitation": 1}, "gravitation")
        self.refuse(self.body(colour=[1, 1, 1]), "colour", "bodies[0]")
        self.refuse({"bodies": [], "planes": [{"height": 1}]}, "height")
        self.refuse({"bodies": [], "meshes": {"m": {"generate": "sphere", "radius": 1, "segments": 3}}}, "segments")
        self.refuse({"bodies": [], "meshes": {"m": {"generate": "sphere", "radius": 1, "repair": True}}}, "repair")

    def test_wrong_values(self):
        self.refuse({}, "bodies")
        self.refuse({"bodies": [], "dt": 0}, "dt")
        self.refuse({"bodies": [], "dt": "fast"}, "dt")
        self.refuse({"bodies": [], "steps": 1.5}, "steps")
        self.refuse({"bodies": [], "gravity": [0, 0]}, "gravity")
        self.refuse({"bodies": [], "stepper": "slow"}, "stepper")
        self.refuse({"bodies": [], "space": "outer"}, "space")
        self.refuse({"bodies": [], "max_contacts": 65536}, "max_contacts")
        self.refuse({"bodies": [], "contacts_per_region": 65}, "contacts_per_region")
        self.refuse({"bodies": [], "region_merge": -1}, "region_merge")
        self.refuse({"bodies": [], "history": "yes"}, "history")
        self.refuse({"bodies": [], "mu": "infinite"}, "mu")
        self.refuse({"bodies": [], "mu": -1}, "mu")
        self.refuse(self.body(rotation=[2, 0, 0, 0]), "rotation")
        self.refuse(self.body(position=[0, 0, 1e999]), "")
        self.refuse(self.body(mass=0), "mass")
        self.refuse(self.body(mass=1, density=1), "density")
        self.refuse(self.body(static=True, mass=1), "mass")
        self.refuse(self.body(box=[1, 1, 1]), "exactly one")
        self.refuse({"bodies": [{"name": "a"}]}, "exactly one")
        self.refuse({"bodies": [{"sphere": 1}]}, "name")
        self.refuse({"bodies": [{"name": "a", "sphere": 1}] * 2}, "two bodies")
        self.refuse({"bodies": [{"name": "a", "sphere": -1}]}, "sphere")
        self.refuse({"bodies": [{"name": "a", "mesh": "m"}]}, "'m'")
        self.refuse({"bodies": [{"name": "a", "capsule": [1, 1], "collider": "gpu_trimesh"}]}, "capsule")

    def test_bad_meshes(self):
        def scene(mesh, **keys):
            return {"meshes": {"m": mesh}, "bodies": [{"name": "a", "mesh": "m", **keys}]}
        self.assert_fails(1, "simulate", self.write("bad.json", json.dumps(scene({"file": "no.ply"}))), says="no.ply")
        self.refuse(scene({}), "file", "generate")
        self.refuse(scene({"generate": "teapot"}), "teapot")
        self.refuse(scene({"generate": "box", "size": [1, 1, 0]}), "size")
        self.refuse(scene({"generate": "torus", "major_radius": 1, "minor_radius": 0.1, "major_segments": 4096,
                           "minor_segments": 4096}), "5 million")
        self.refuse(scene({"generate": "bolt", "radius": 1, "length": 1, "pitch": 1e-8}), "5 million")
        self.refuse(scene({"generate": "gear", "pitch_radius": 1, "tooth_depth": 0.1, "width": 1, "bore_radius": 5}),
                    "no solid")
        self.write("nan.ply", ply([(float("nan"), 0, 0)] * 3, [(0, 1, 2)]))
        self.refuse(scene({"file": "nan.ply"}), "meshes.m")
        self.write("flat.ply", ply([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
        self.assert_fails(1, "simulate", self.write("flat.json", json.dumps(scene({"file": "flat.ply"}))), says="flat")
        self.run_otg("simulate", self.write("ok.json", json.dumps(scene({"file": "flat.ply"}, static=True))))

    def test_wrong_options(self):
        path = self.write("scene.json", json.dumps(self.body()))
        for options in (["--steps", "-1"], ["--steps", "x"], ["--dt", "0"], ["--dt", "-1"], ["--frobnicate"],
                        ["--contacts-per-region", "0"]):
            self.assert_fails(2, "simulate", path, *options)
        self.assert_fails(1, "simulate", path, "--csv", "no/such/folder.csv", says="no/such/folder.csv")
        self.assert_fails(1, "simulate", path, "--glb", "no/such/folder.glb", says="no/such/folder.glb")


if __name__ == "__main__":
    cli_support.main()
