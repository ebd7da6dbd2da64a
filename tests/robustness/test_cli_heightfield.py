# SPDX-License-Identifier: BSD-3-Clause
"""Heightfields on the command line: otg simulate, otg collide."""
import json
import math

import cli_support
from cli_support import CliTest, box, ply

QUARTER = [math.sqrt(0.5), 0, 0, math.sqrt(0.5)]  # a quarter of a turn round z
STEPS = {"size": [4, 4], "heights": [[0, 0, 1, 1], [0, 0, 1, 1], [2, 2, 3, 3], [2, 2, 3, 3]]}


class Heightfields(CliTest):
    def simulate(self, scene, *options):
        return self.run_json("simulate", self.write("scene.json", json.dumps(scene)), *options)

    def test_which_height_lies_where(self):
        """Boxes on the four terraces of a field rest at their heights, also where the field is turned and moved."""
        for turn in range(4):
            half = turn * math.pi / 4
            places = [(x, y, height) for x, y, height in
                      ((-1.4, -1.4, 0), (1.4, -1.4, 1), (-1.4, 1.4, 2), (1.4, 1.4, 3))]
            c, s = round(math.cos(2 * half)), round(math.sin(2 * half))
            bodies = [{"name": "ground", "heightfield": "steps", "static": True, "position": [10, 20, 5],
                       "rotation": [math.cos(half), 0, 0, math.sin(half)]}]
            for i, (x, y, height) in enumerate(places):
                bodies.append({"name": str(i), "box": [0.4, 0.4, 0.4], "collider": "gpu_trimesh",
                               "position": [10 + c * x - s * y, 20 + s * x + c * y, 5 + height + 0.21]})
            document = self.simulate({"steps": 200, "heightfields": {"steps": STEPS}, "bodies": bodies})
            self.assertEqual(document["bodies"][0]["position"], [10, 20, 5])
            for got, expected in zip(document["bodies"][0]["rotation"], bodies[0]["rotation"], strict=True):
                self.assertAlmostEqual(got, expected)
            for body, place in zip(document["bodies"][1:], bodies[1:], strict=True):
                for got, expected in zip(body["position"], place["position"], strict=True):
                    self.assertLess(abs(got - expected), 0.015, (turn, body))

    def test_a_slope_without_friction(self):
        """A mesh box slides down with g sin(angle); with enough friction it stays."""
        rise = 0.25
        angle = math.atan(rise)
        turn = [math.cos(angle / 2), 0, -math.sin(angle / 2), 0]
        up = [-math.sin(angle) * 0.2, 0, math.cos(angle) * 0.2]
        scene = {"steps": 200, "mu": 0, "stepper": "world", "heightfields": {
            "slope": {"size": [20, 4], "generate": "slope", "rise": rise, "samples": [41, 9]}},
            "bodies": [{"name": "ground", "heightfield": "slope", "static": True},
                       {"name": "box", "box": [0.4, 0.4, 0.4], "collider": "gpu_trimesh", "rotation": turn,
                        "position": up}]}
        free = self.simulate(scene)["bodies"][1]
        along = free["linear_velocity"][0] / math.cos(angle)
        self.assertLess(abs(along + 9.81 * math.sin(angle) * 1.0), 0.01, free)
        self.assertLess(abs(free["linear_velocity"][1]), 1e-3)
        held = self.simulate({**scene, "mu": 1})["bodies"][1]
        for got, expected in zip(held["position"], up, strict=True):
            self.assertLess(abs(got - expected), 2e-3, held)

    def test_meshes_go_as_ode_s_own_and_as_on_a_mesh_of_the_field(self):
        """Over uneven ground: the box mesh as dBox, and on the field as on the mesh that the field can be instead."""
        field = {"size": [8, 6], "generate": "rough", "height": 0.8, "length": 6, "seed": 4, "samples": [17, 13]}
        ends = []
        for ground, collider in (("primitive", "gpu_trimesh"), ("primitive", "primitive"),
                                 ("gpu_trimesh", "gpu_trimesh")):
            document = self.simulate({
                "steps": 400, "stepper": "world", "heightfields": {"field": field}, "bodies": [
                    {"name": "ground", "heightfield": "field", "static": True, "collider": ground},
                    {"name": "box", "box": [1.5, 1.5, 0.5], "collider": collider, "position": [0.2, 0.1, 1.5]}]})
            ends.append(document["bodies"][1])
            self.assertLess(max(abs(v) for v in ends[-1]["linear_velocity"]), 0.05, ends[-1])
        for other in ends[1:]:
            for got, expected in zip(ends[0]["position"], other["position"], strict=True):
                self.assertLess(abs(got - expected), 0.1, ends)

    def test_same_seed_same_ground(self):
        def scene(**field):
            return {"steps": 60, "heightfields": {"f": {"size": [4, 4], "generate": "rough", "height": 0.3,
                                                        "length": 2, **field}},
                    "bodies": [{"name": "ground", "heightfield": "f", "static": True},
                               {"name": "lump", "mesh": "l", "position": [0, 0, 0.5]}],
                    "meshes": {"l": {"generate": "lump", "radius": 0.3, "level": 2}}}
        first = self.simulate(scene(seed=3))["hash"]
        self.assertEqual(self.simulate(scene(seed=3))["hash"], first)
        self.assertEqual(self.simulate(scene(seed=3), "--prefetch")["hash"], first)
        self.assertNotEqual(self.simulate(scene(seed=4))["hash"], first)
        # It goes on beyond its edges only if it wraps.
        away = scene(seed=3)
        away["bodies"][1]["position"] = [40, 0, 0.5]
        self.assertLess(self.simulate(away, "--steps", "200")["bodies"][1]["position"][2], -2)
        away["heightfields"]["f"]["wrap"] = True
        self.assertGreater(self.simulate(away, "--steps", "200")["bodies"][1]["position"][2], -0.3)

    def test_bad_fields(self):
        def refuse(field, *says, body=None):
            scene = {"heightfields": {"f": field},
                     "bodies": [{"name": "g", "heightfield": "f", "static": True, **(body or {})}]}
            self.assert_fails(1, "simulate", self.write("bad.json", json.dumps(scene)), says=["bad.json", *says])
        flat = {"size": [1, 1], "generate": "flat"}
        refuse({}, "size")
        refuse({"size": [1, 0], "generate": "flat"}, "size")
        refuse({"size": [1, 1]}, "heights", "generate")
        refuse({**flat, "heights": [[0, 0], [0, 0]]}, "heights", "generate")
        refuse({"size": [1, 1], "heights": [[0, 0]]}, "2 rows")
        refuse({"size": [1, 1], "heights": [[0, 0], [0]]}, "same number")
        refuse({"size": [1, 1], "heights": [[0, 0], [0, "x"]]}, "number")
        refuse({"size": [1, 1], "generate": "sea"}, "sea")
        refuse({"size": [1, 1], "generate": "hills"}, "height")
        refuse({**flat, "samples": [1, 5]}, "samples")
        refuse({**flat, "samples": [5000, 5000]}, "2.5 million")
        refuse({**flat, "depth": 3}, "depth")
        refuse({**flat, "thickness": -1}, "thickness")
        refuse(flat, "static", body={"static": False})
        refuse(flat, "right angles", body={"rotation": [math.cos(0.1), 0, 0, math.sin(0.1)]})
        refuse({**flat, "wrap": True}, "wraps", body={"collider": "gpu_trimesh"})
        refuse(flat, "'h'", body={"heightfield": "h"})

    def test_collide(self):
        mesh = self.writeBox()
        field = self.write("field.json", json.dumps({"size": [4, 4], "generate": "flat", "samples": [9, 9]}))
        document = self.run_json("collide", mesh, field, "--pose", "0.1,0.2,-0.49,1,0,0,0", "--repeat", "3")
        self.assert_keys(document, "contacts timings_ms backend device hash")
        self.assertGreaterEqual(len(document["contacts"]), 4)
        for contact in document["contacts"]:
            self.assertAlmostEqual(contact["depth"], 0.01, places=6)
            self.assertIn(contact["triangle_a"], range(12))
            for got, expected in zip(contact["normal"], (0, 0, 1), strict=True):
                self.assertAlmostEqual(got, expected, places=6)
        self.assertIn("triangle A", self.run_otg("collide", mesh, field, "--pose", "0,0,-0.49,1,0,0,0").stdout)
        self.assertEqual(self.run_json("collide", mesh, field, "--pose", "0,0,-0.51,1,0,0,0")["contacts"], [])
        # A slope along y: the normal leans towards -y, and the depth is across the slope.
        rise = self.write("rise.json", json.dumps({"size": [4, 4], "heights": [[-1, -1], [1, 1]]}))
        self.write("point.ply", ply(*box(size=(0.01, 0.01, 0.01))))
        contacts = self.run_json("collide", self.path("point.ply"), rise, "--pose", "0,0,0.004,1,0,0,0")["contacts"]
        lean = math.atan(0.5)
        deepest = max(contact["depth"] for contact in contacts)  # a lower edge, 5 mm down and 5 mm towards the slope
        self.assertAlmostEqual(deepest, (0.004 + 0.005 + 0.0025) * math.cos(lean), places=6)
        for got, expected in zip(contacts[0]["normal"], (0, -math.sin(lean), math.cos(lean)), strict=True):
            self.assertAlmostEqual(got, expected, places=6)
        limited = self.run_json("collide", mesh, field, "--pose", "0,0,-0.49,1,0,0,0", "--max-contacts", "2")
        self.assertEqual(len(limited["contacts"]), 2)
        self.assert_fails(2, "collide", field, mesh, says="second")
        self.assert_fails(2, "collide", mesh, field, "--backend", "cpu", says="heightfield")
        self.assert_fails(1, "collide", mesh, "no.json", says="no.json")
        self.assert_fails(1, "collide", mesh, self.write("bad.json", "{"), says="bad.json")


if __name__ == "__main__":
    cli_support.main()
