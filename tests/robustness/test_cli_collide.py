# SPDX-License-Identifier: BSD-3-Clause
"""otg collide: keys, poses, options, and what it says about bad ones."""
import itertools
import json
import math
import os
import pathlib

import cli_support
from cli_support import CliTest, lump, ply


class Collide(CliTest):
    KEYS = ("candidate_pairs box_tests intersecting_pairs contacts_before_reduction contacts timings_ms backend device "
            "hash")

    def test_keys(self):
        mesh = self.writeBox()
        document = self.run_json("collide", mesh, mesh, "--pose", "0.9,0.1,0.2,1,0,0,0", "--repeat", "3")
        self.assert_keys(document, self.KEYS)
        self.assert_keys(document["timings_ms"], "build middle near contacts reduction transfer total")
        self.assertTrue(document["contacts"])
        for contact in document["contacts"]:
            self.assert_keys(contact, "position normal depth triangle_a triangle_b")
            self.assertAlmostEqual(sum(x * x for x in contact["normal"]), 1)
            self.assertGreaterEqual(contact["depth"], 0)
            self.assertIn(contact["triangle_a"], range(12))
            self.assertIn(contact["triangle_b"], range(12))
        self.assertEqual(document["backend"], "cpu")
        self.assertGreater(document["timings_ms"]["total"], 0)
        self.assertIn("candidate_pairs", self.run_otg("collide", mesh, mesh, "--pose", "0.9,0,0,1,0,0,0").stdout)

    def test_same_query_same_bytes(self):
        mesh = self.write("lump.ply", ply(*lump()))
        runs = [self.run_json("collide", mesh, mesh, "--pose", "1.5,0.1,0.3,0.8,0.6,0,0") for _ in range(2)]
        for run in runs:
            del run["timings_ms"]
        self.assertEqual(runs[0], runs[1])
        self.assertTrue(runs[0]["contacts"])
        other = self.run_json("collide", mesh, mesh, "--pose", "1.5,0.1,0.30001,0.8,0.6,0,0")
        self.assertNotEqual(other["hash"], runs[0]["hash"])

    def test_apart(self):
        mesh = self.writeBox()
        document = self.run_json("collide", mesh, mesh, "--pose", "5,0,0,1,0,0,0")
        self.assertEqual((document["contacts"], document["intersecting_pairs"]), ([], 0))

    def test_every_way_finds_the_same(self):
        mesh = self.write("lump.ply", ply(*lump(12)))
        answers = set()
        for midphase, descent, build, axes in itertools.product(
                ("standard", "quantized", "noleaf", "wide"), ("first", "larger", "alternating", "both"),
                ("mean", "sah"), ("6", "15")):
            document = self.run_json("collide", mesh, mesh, "--pose", "1.4,0.1,0.3,0.8,0,0.6,0", "--midphase", midphase,
                                     "--descent", descent, "--build", build, "--axes", axes)
            answers.add((document["intersecting_pairs"], document["hash"]))
        self.assertEqual(len(answers), 1)

    def test_reduction_and_limits(self):
        mesh = self.write("lump.ply", ply(*lump()))
        arguments = ["collide", mesh, mesh, "--pose", "1.5,0.1,0.3,0.8,0.6,0,0"]
        whole = self.run_json(*arguments, "--reduction", "none", "--max-contacts", "65535")
        self.assertEqual(len(whole["contacts"]), whole["contacts_before_reduction"])
        for options in (["--reduction", "binning", "--bins", "2"], ["--reduction", "binning", "--bins", "1,2,3,1,2,3"],
                        ["--reduction", "cone"], ["--contacts", "pairwise"],
                        ["--contacts", "pairwise", "--backend", "cpu"],
                        ["--contacts", "pairwise", "--midphase", "cpu", "--nearphase", "cpu"],
                        ["--contacts", "pairwise", "--backend", "auto"]):
            document = self.run_json(*arguments, *options)
            self.assertEqual(document["contacts_before_reduction"], whole["contacts_before_reduction"])
            self.assertLess(len(document["contacts"]), len(whole["contacts"]))
            self.assertTrue(document["contacts"])
        self.assertEqual(len(self.run_json(*arguments, "--max-contacts", "1")["contacts"]), 1)

    def test_two_solids_collide_as_solids_unless_a_reduction_is_named(self):
        mesh = self.writeBox()
        arguments = ["collide", mesh, mesh, "--pose", "0.1,0.05,0.9,1,0,0,0"]
        default = self.run_json(*arguments)
        self.assertEqual(default["hash"], self.run_json(*arguments, "--contacts", "solid")["hash"])
        self.assertNotEqual(default["hash"], self.run_json(*arguments, "--contacts", "pairwise")["hash"])
        self.assertEqual(self.run_json(*arguments, "--reduction", "binning")["hash"],
                         self.run_json(*arguments, "--contacts", "pairwise")["hash"])

    def test_features_of_contacts(self):
        # A's box reaches into the side of B's larger one: its four vertices are inside.
        small, large = self.writeBox("small.ply"), self.writeBox("large.ply", size=(4, 4, 4))
        document = self.run_json("collide", small, large, "--pose", "2.4,0.1,0.2,1,0,0,0")
        vertices = [contact for contact in document["contacts"] if contact["feature"] == "vertex"]
        # Corners 4 to 7 are the ones at x = 0.5 (BOX_VERTICES).
        self.assertEqual(sorted(contact["vertices"] for contact in vertices), [[4], [5], [6], [7]])
        for contact in vertices:
            self.assertEqual((contact["feature_mesh"], contact["inside"], contact["contained"], contact["clamped"]),
                             ("a", True, False, False))
            self.assertAlmostEqual(contact["coherence"], 1)
        ids = [contact["id"] for contact in document["contacts"]]
        self.assertEqual(len(set(ids)), len(ids))
        moved = self.run_json("collide", small, large, "--pose", "2.41,0.11,0.2,1,0,0,0")
        self.assertEqual({c["id"] for c in vertices},
                         {c["id"] for c in moved["contacts"] if c["feature"] == "vertex"})
        inner = self.run_json("collide", small, large, "--pose", "0.4,0.1,0.2,1,0,0,0")
        self.assertTrue(all(contact["contained"] for contact in inner["contacts"]))
        text = self.run_otg("collide", small, large, "--pose", "0.4,0.1,0.2,1,0,0,0").stdout
        self.assertEqual(text.count("  contained\n"), len(inner["contacts"]))
        self.assertNotIn("remarks", self.run_otg("collide", small, large, "--pose", "2.4,0.1,0.2,1,0,0,0").stdout)
        # Two bars through each other: their surfaces contradict, so depths are cut.
        bars = self.writeBox("x.ply", size=(4, 0.3, 0.3)), self.writeBox("y.ply", size=(0.3, 4, 0.3))
        crossed = self.run_json("collide", *bars, "--pose", "0.01,0.02,0.015,1,0,0,0")["contacts"]
        self.assertTrue(crossed and all(contact["clamped"] for contact in crossed))
        text = self.run_otg("collide", *bars, "--pose", "0.01,0.02,0.015,1,0,0,0").stdout
        self.assertEqual(text.count("  clamped\n"), len(crossed))
        pairwise = self.run_json("collide", small, large, "--pose", "2.4,0.1,0.2,1,0,0,0", "--contacts", "pairwise")
        for contact in pairwise["contacts"]:
            self.assertEqual((contact["coherence"], contact["vertices"]), (None, []))
            self.assertIn(contact["feature"], ("face", "coplanar"))

    def test_contacts_per_region(self):
        mesh = self.write("lump.ply", ply(*lump()))
        pose = ["--pose", "1.5,0.1,0.3,0.8,0.6,0,0"]
        totals = []
        for most in (1, 2, 8):
            counts = {}
            for contact in self.run_json("collide", mesh, mesh, *pose, "--contacts-per-region", str(most))["contacts"]:
                counts[contact["region"]] = counts.get(contact["region"], 0) + 1
            self.assertLessEqual(max(counts.values()), most)
            totals.append(sum(counts.values()))
        self.assertTrue(totals[0] <= totals[1] < totals[2], totals)
        for wrong in ("0", "65", "x"):
            self.assert_fails(2, "collide", mesh, mesh, *pose, "--contacts-per-region", wrong)

    def test_region_merge(self):
        mesh = self.write("lump.ply", ply(*lump()))
        pose = ["--pose", "1.5,0.1,0.3,0.8,0.6,0,0"]
        apart = self.run_json("collide", mesh, mesh, *pose)["contacts"]
        self.assertEqual(apart, self.run_json("collide", mesh, mesh, *pose, "--region-merge", "0")["contacts"])
        # Normals have to agree, too: what is one region may be all contacts, but those that oppose each other.
        merged = self.run_json("collide", mesh, mesh, *pose, "--region-merge", "100")["contacts"]
        self.assertLessEqual(len({c["region"] for c in merged}), len({c["region"] for c in apart}))
        ids = {c["id"] for c in apart}
        self.assertTrue(merged and all(c["id"] in ids for c in merged))
        for wrong in ("-1", "x"):
            self.assert_fails(2, "collide", mesh, mesh, *pose, "--region-merge", wrong)

    def test_a_device_that_is_not_there(self):
        """The CPU does what devices cannot, whatever the reason, and says so; a number that names none is a mistake."""
        mesh = self.write("lump.ply", ply(*lump(10)))
        pair = ["collide", mesh, mesh, "--pose", "1.5,0.1,0.3,0.8,0.6,0,0", "--profile"]
        nothing = {"OTG_OPENCL_DEVICE": "none"}
        for model in ("pairwise", "solid"):
            expected = self.run_json(*pair, "--contacts", model)
            for where in (["--backend", "opencl"], ["--midphase", "opencl"], ["--nearphase", "opencl"],
                          ["--midphase", "levels"]):
                found = self.run_json(*pair, "--contacts", model, *where, env=nothing)
                for key in ("contacts", "hash", "backend", "device", "midphase", "nearphase", "candidate_pairs"):
                    self.assertEqual(found[key], expected[key], (where, key))
                self.assertEqual([row["what"] for row in found["profile"]], [r["what"] for r in expected["profile"]])
                self.assertNotIn("levels", found)
                said = self.run_otg(*pair, "--contacts", model, *where, env=nothing).stderr
                self.assertEqual(said.count("\n"), 1, said)
                self.assertIn("no OpenCL device", said)
        self.assertEqual(self.run_otg(*pair, "--backend", "auto", env=nothing).stderr, "")

    def test_a_device_that_fails(self):
        """Kernels that do not build: the contacts of the CPU, a note, and `backend` says who computed."""
        if self.run_json("devices")["used"] is None:
            self.skipTest("no OpenCL device")
        sources = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "kernels")
        for kernel in pathlib.Path(sources).rglob("*.cl"):
            name = kernel.relative_to(sources)
            os.makedirs(self.path(str(name.parent)), exist_ok=True)
            self.write(str(name), "this is no kernel\n")
        mesh = self.write("lump.ply", ply(*lump(10)))
        pose = "1.5,0.1,0.3,0.8,0.6,0,0"
        scene = self.write("scene.json", json.dumps({"meshes": [mesh], "pairs": [[0, 0, pose]] * 3}))
        broken = {"OTG_KERNEL_DIR": self.folder, "OTG_CACHE_DIR": self.path("cache")}
        pair = ["collide", mesh, mesh, "--pose", pose]
        for arguments, where in ((pair, ["--backend", "opencl"]), (pair, ["--midphase", "opencl"]),
                                 (pair, ["--midphase", "levels"]), (["batch", scene], ["--backend", "opencl"])):
            for model in ("pairwise", "solid"):
                expected = self.run_json(*arguments, "--contacts", model)
                done = self.run_otg(*arguments, "--contacts", model, *where, "--json", env=broken)
                found = json.loads(done.stdout)
                self.assertEqual((found["hash"], found["backend"]), (expected["hash"], "cpu"), (where, model))
                self.assertIn("note: ", done.stderr)
                self.assertIn("clBuildProgram", done.stderr)

    def test_what_this_build_cannot_do(self):
        mesh = self.writeBox()
        self.assert_fails(1, "collide", mesh, mesh, "--backend", "opencl", "--device", "99", says="OpenCL")
        self.assert_fails(1, "collide", mesh, mesh, "--midphase", "opencl", "--device", "99", says="OpenCL")

    def test_profile(self):
        mesh = self.write("lump.ply", ply(*lump()))
        arguments = ["collide", mesh, mesh, "--pose", "1.5,0.1,0.3,0.8,0.6,0,0", "--contacts", "pairwise", "--profile"]
        stages = "upload top main near contacts reduction read-back host".split()
        backends = ["cpu", "opencl"] if self.run_json("devices")["used"] is not None else ["cpu"]
        for backend in backends:
            document = self.run_json(*arguments, "--backend", backend, "--repeat", "3")
            self.assertEqual([row["stage"] for row in document["profile"]], stages)
            self.assertTrue(all(row["ms"] >= 0 and row["what"] for row in document["profile"]))
            self.assertGreater(sum(row["ms"] for row in document["profile"]), 0)
            text = self.run_otg(*arguments, "--backend", backend).stdout
            self.assertTrue(all(stage in text for stage in stages))

    def test_levels(self):
        """The published traversal on a device: the contacts of the CPU, and what happened at each depth."""
        mesh = self.write("lump.ply", ply(*lump()))
        arguments = ["collide", mesh, mesh, "--pose", "1.5,0.1,0.3,0.8,0.6,0,0", "--profile"]
        levels = [*arguments, "--midphase", "levels"]
        for wrong in (["--backend", "cpu"], ["--start-depth", "13"], ["--start-depth", "-1"], ["--prefix-sums", "none"],
                      ["--nearphase", "cpu", "--split-near"]):
            self.assert_fails(2, *levels, *wrong)
        if self.run_json("devices")["used"] is None:
            return
        for model in ("pairwise", "solid"):
            expected = self.run_json(*arguments, "--contacts", model)
            for options in ([], ["--send-trees", "--start-depth", "0"], ["--split-near", "--start-depth", "12"]):
                found = self.run_json(*levels, "--contacts", model, *options)
                self.assertEqual(found["contacts"], expected["contacts"])
                self.assertEqual((found["midphase"], found["nearphase"]), ("levels", "opencl"))
                self.assertEqual([row["stage"] for row in found["profile"]], [r["stage"] for r in expected["profile"]])
                self.assertAlmostEqual(sum(row["percent"] for row in found["levels"]["profile"]), 100, delta=1)
                depths = found["levels"]["per_depth"]
                self.assertEqual(sum(row["box_tests"] for row in depths), found["box_tests"])
                self.assertEqual(sum(row["leaf_pairs"] for row in depths), found["candidate_pairs"])
                self.assertEqual(depths[0]["depth"], int(options[-1]) if options else 6)
                self.assertEqual(found["levels"]["trees"], "sent" if "--send-trees" in options else "resident")
        text = self.run_otg(*levels, "--contacts", "pairwise").stdout
        for word in ("scan", "compaction", "leaf_pairs"):
            self.assertIn(word, text)

    def test_mixtures(self):
        """Any mid phase with any narrow phase: the contacts of the CPU."""
        mesh = self.write("lump.ply", ply(*lump()))
        arguments = ["collide", mesh, mesh, "--pose", "1.5,0.1,0.3,0.8,0.6,0,0", "--profile"]
        if self.run_json("devices")["used"] is None:
            return
        for model in ("pairwise", "solid"):
            expected = self.run_json(*arguments, "--contacts", model)
            for middle in ("levels", "standard", "opencl", "cpu"):
                for near in ("cpu", "published", "filtered"):
                    options = ["--midphase", middle, "--nearphase", near, "--contacts", model]
                    if middle == "levels":
                        options += ["--send-trees", "--prefix-sums", "single-pass"]
                    found = self.run_json(*arguments, *options)
                    self.assertEqual(found["contacts"], expected["contacts"], options)
                    name = {"cpu": "wide"}.get(middle, middle)
                    self.assertEqual((found["midphase"], found["nearphase"]), (name, near))
                    self.assertAlmostEqual(sum(row["percent"] for row in found["profile"]), 100, delta=1)
                    if near == "cpu":
                        continue
                    gathered = found["gathered"]
                    self.assertEqual(gathered["pairs"], found["candidate_pairs"])
                    self.assertEqual(gathered["bytes_sent"], 8 * gathered["pairs"] + 48 * gathered["triangles"])
                    self.assertAlmostEqual(sum(row["percent"] for row in gathered["profile"]), 100, delta=1)
        text = self.run_otg(*arguments, "--midphase", "levels", "--nearphase", "published").stdout
        for word in ("gather", "scan", "leaf_pairs"):
            self.assertIn(word, text)
        pairs = self.run_json("pairs", mesh, mesh, *arguments[3:5], "--midphase", "levels", "--nearphase", "published")
        self.assertEqual(pairs["intersecting_pairs"], expected["intersecting_pairs"])

    def test_wrong_options(self):
        mesh = self.writeBox()
        for options in (["--bins", "1,2"], ["--bins", "0"], ["--bins", "65"], ["--max-contacts", "0"],
                        ["--max-contacts", "65536"], ["--repeat", "0"], ["--backend", "abacus"], ["--axes", "7"],
                        ["--reduction", "magic"], ["--contacts", "none"], ["--midphase", "x"], ["--frobnicate"]):
            self.assert_fails(2, "collide", mesh, mesh, *options, says=options[0].lstrip("-"))
        self.assert_fails(2, "collide", mesh)
        self.assert_fails(2, "collide", mesh, mesh, mesh)

    def test_cooked_meshes_are_read_by_every_command(self):
        mesh = self.write("lump.ply", ply(*lump()))
        self.run_otg("cook", mesh, "-o", "lump.otg")
        words = ["--pose", "1.4,0.1,0.3,0.8,0,0.6,0"]
        expected = self.run_json("collide", mesh, mesh, *words)
        for a, b in ((mesh, "lump.otg"), ("lump.otg", "lump.otg")):
            self.assertEqual(self.run_json("collide", a, b, *words)["hash"], expected["hash"])
            self.assertEqual(self.run_otg("pairs", a, b, *words, "--out", "-").stdout,
                             self.run_otg("pairs", mesh, mesh, *words, "--out", "-").stdout)
        for name, mesh_file in (("cooked", "lump.otg"), ("plain", mesh)):
            pairs = {"meshes": [mesh_file], "pairs": [[0, 0, words[1]]]}
            scene = {"steps": 3, "meshes": {"lump": {"file": mesh_file}}, "bodies": [{"name": "lump", "mesh": "lump"}]}
            self.write(name + "_pairs.json", json.dumps(pairs))
            self.write(name + "_scene.json", json.dumps(scene))
        self.write("field.json", '{"size": [4, 4], "generate": "flat"}')
        for command in (["batch", "%s_pairs.json"], ["simulate", "%s_scene.json"]):
            plain, cooked = ([command[0], self.path(command[1] % name)] for name in ("plain", "cooked"))
            self.assertEqual(self.run_json(*cooked)["hash"], self.run_json(*plain)["hash"])
        on_field = [self.run_json("collide", file, "field.json", "--pose", "0,0,-0.5,1,0,0,0")
                    for file in ("lump.otg", mesh)]
        self.assertGreater(len(on_field[0]["contacts"]), 0)
        self.assertEqual(on_field[0]["hash"], on_field[1]["hash"])
        # A cooked mesh adds its triangles in an order of its own, so the last digits differ.
        self.assertAlmostEqual(self.run_json("check", "lump.otg")["volume"], self.run_json("check", mesh)["volume"], 12)
        self.run_otg("cook", "lump.otg", "-o", "again.otg")
        with open(self.path("lump.otg"), "rb") as file, open(self.path("again.otg"), "rb") as again:
            self.assertEqual(file.read(), again.read())
        with open(self.path("lump.otg"), "r+b") as file:
            file.truncate(1000)
        self.assert_fails(1, "collide", "lump.otg", mesh, *words, says="lump.otg: ")

    def test_bad_meshes(self):
        mesh = self.writeBox()
        self.assert_fails(1, "collide", mesh, "missing.ply", says="missing.ply")
        self.assert_fails(1, "collide", self.write("bad.ply", ply([(float("inf"), 0, 0)] * 3, [(0, 1, 2)])), mesh,
                          "--json", says="bad.ply")


class Pose(CliTest):
    def contacts(self, *pose):
        document = self.run_json("collide", self.path("box.ply"), self.path("box.ply"), *pose)
        return document["hash"], document["intersecting_pairs"]

    def test_ways_to_say_it(self):
        self.writeBox()
        expected = self.contacts("--pose", "0.25,-0.5,0.75,0.8,0.6,0,0")
        self.assertGreater(expected[1], 0)
        # Turned about x by the angle with cosine 0.8^2 - 0.6^2 = 0.28 and sine 0.96.
        w, x = 0.8 / math.hypot(0.8, 0.6), 0.6 / math.hypot(0.8, 0.6)
        c, s = 1 - 2 * (x * x), 2 * (w * x)
        rows = [[1, 0, 0, 0.25], [0, c, -s, -0.5], [0, s, c, 0.75], [0, 0, 0, 1]]
        text = "\n".join(" ".join(repr(v) for v in row) for row in rows)
        flat = [v for row in rows for v in row]
        files = {"m.txt": text, "m.csv": text.replace(" ", ", "), "m": text, "nested.json": json.dumps(rows),
                 "flat.json": json.dumps(flat), "T.json": json.dumps({"T": flat})}
        for name, content in files.items():
            self.assertEqual(self.contacts("--pose", self.write(name, content)), expected, name)
        named = self.write("poses.json", json.dumps({"here": {"T": flat}, "there": rows}))
        self.assertEqual(self.contacts("--pose", named + "#here"), expected)
        self.assertEqual(self.contacts("--pose", named + "#there"), expected)
        for spelling in ("0.25,-0.5,0.75,0.8,0.6,0,0", "0.25, -0.5, 0.75, 0.8, 0.6, 0, 0", "2.5e-1,-.5,+0.75,.8,.6,0,0",
                         "0.25,-0.5,0.75,-0.8,-0.6,0,0"):
            self.assertEqual(self.contacts("--pose", spelling), expected, spelling)
        self.assertEqual(self.contacts("--pose=-0.25,0,0,1,0,0,0"), self.contacts("--pose", "-0.25,0,0,1,0,0,0"))
        self.assertEqual(self.contacts("--pose", "-.25,0,0,1,0,0,0"), self.contacts("--pose", "-0.25,0,0,1,0,0,0"))

    def test_wrong_text_is_wrong_usage(self):
        mesh = self.writeBox()
        for pose in ("1,2,3", "1,2,3,1,0,0", "1,2,3,1,0,0,0,0", "a,b,c,d,e,f,g", "1,2,3,1,0,0,x", "nonsense", ""):
            self.assert_fails(2, "collide", mesh, mesh, "--pose", pose, says="pose")
        self.assert_fails(2, "collide", mesh, mesh, "--pose")

    def test_wrong_values_are_bad_input(self):
        mesh = self.writeBox()
        for pose in ("0,0,0,0,0,0,0", "0,0,0,2,0,0,0", "nan,0,0,1,0,0,0", "0,0,0,nan,0,0,0", "inf,0,0,1,0,0,0"):
            self.assert_fails(1, "collide", mesh, mesh, "--pose", pose, says="pose")
        files = {"short.txt": "1 0 0", "words.txt": "one two three", "nan.txt": "nan " * 16,
                 "row.txt": "1 0 0 0  0 1 0 0  0 0 1 0  0 0 1 1", "scale.txt": "2 0 0 0  0 2 0 0  0 0 2 0  0 0 0 1",
                 "mirror.txt": "-1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1", "empty.txt": "", "list.json": "[1, [2, \"x\"]]",
                 "object.json": "{}"}
        for name, content in files.items():
            self.assert_fails(1, "collide", mesh, mesh, "--pose", self.write(name, content), says=name)
        self.assert_fails(1, "collide", mesh, mesh, "--pose", "missing.txt", says="missing.txt")

    def test_what_is_no_rotation_is_refused(self):
        mesh = self.writeBox()
        refused = {"scale.txt": "1.001 0 0 0  0 1.001 0 0  0 0 1.001 0  0 0 0 1",
                   "stretch.txt": "1 0 0 0  0 1.001 0 0  0 0 1 0  0 0 0 1",
                   "shear.txt": "1 0.001 0 0  0 1 0 0  0 0 1 0  0 0 0 1",
                   "mirror.txt": "-1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1",
                   "flat.txt": "1 0 0 0  0 1 0 0  0 0 0 0  0 0 0 1"}
        for name, content in refused.items():
            path = self.write(name, content)
            for command in (["collide", mesh, mesh], ["pairs", mesh, mesh]):
                self.assert_fails(1, *command, "--pose", path, says=[name, "must be a rotation"])

    def test_what_is_nearly_a_rotation_is_used_as_given(self):
        mesh = self.writeBox()
        # A box stretched by 4e-4 along x, moved to where only its stretched half reaches the other's face.
        for size, pairs, warning in ((1.0004, True, "warning"), (1.0, False, "")):
            path = self.write("pose.txt", "%r 0 0 1.0001  0 1 0 0.3  0 0 1 0.2  0 0 0 1" % size)
            result = self.run_otg("collide", mesh, mesh, "--pose", path, "--json")
            self.assertEqual(json.loads(result.stdout)["intersecting_pairs"] > 0, pairs)
            self.assertIn(warning, result.stderr)
            self.assertEqual(result.stderr == "", warning == "")

    def test_wrong_poses_of_a_file(self):
        mesh = self.writeBox()
        self.write("object.json", "{}")
        self.assert_fails(1, "collide", mesh, mesh, "--pose", self.path("object.json") + "#touch", says="touch")


if __name__ == "__main__":
    cli_support.main()
