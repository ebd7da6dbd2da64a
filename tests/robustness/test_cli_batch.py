# SPDX-License-Identifier: BSD-3-Clause
"""otg batch and otg devices; both backends where there is an OpenCL device."""
import json
import os
import shutil

import cli_support
from cli_support import CliTest, lump, ply


class Batch(CliTest):
    POSES = ([1.5, 0.1, 0.3, 0.8, 0.6, 0, 0], "0.9,0.1,0.2,1,0,0,0",
             [[1, 0, 0, 0.7], [0, 1, 0, 0.1], [0, 0, 1, 0.2], [0, 0, 0, 1]], [9, 0, 0, 1, 0, 0, 0])

    def writeScene(self, **changes):
        self.writeBox("box.ply")
        self.write("lump.ply", ply(*lump(12)))
        scene = {"meshes": ["box.ply", self.path("lump.ply")],
                 "pairs": [[i, j, pose] for i in (0, 1) for j in (0, 1) for pose in self.POSES]}
        return self.write("scene.json", json.dumps({**scene, **changes}))

    def cacheFiles(self):
        folder = os.environ.get("OTG_CACHE_DIR")
        if folder is None:
            folder = os.path.join(os.environ.get("XDG_CACHE_HOME") or os.path.join(os.environ["HOME"], ".cache"),
                                  "ode_trimesh_gpu")
        return [os.path.join(folder, name) for name in os.listdir(folder)] if os.path.isdir(folder) else []

    def hasDevice(self):
        return self.run_json("devices")["used"] is not None

    def test_keys_and_single_queries(self):
        document = self.run_json("batch", self.writeScene(), "--contacts", "pairwise", "--repeat", "2")
        self.assert_keys(document, "pairs total_contacts timings_ms per_pair_contacts hash backend device")
        self.assertEqual(document["pairs"], 16)
        self.assertEqual(len(document["per_pair_contacts"]), 16)
        self.assertEqual(sum(document["per_pair_contacts"]), document["total_contacts"])
        self.assertEqual(document["backend"], "cpu")
        single = self.run_json("collide", self.path("box.ply"), self.path("lump.ply"), "--pose", self.POSES[1],
                               "--contacts", "pairwise")
        self.assertEqual(document["per_pair_contacts"][5], len(single["contacts"]))
        self.assertEqual(document["per_pair_contacts"][3], 0)
        self.assertIn("total_contacts", self.run_otg("batch", self.path("scene.json")).stdout)

    def test_device_gives_what_the_cpu_gives(self):
        if not self.hasDevice():
            self.skipTest("no OpenCL device")
        scene = self.writeScene()
        for contacts in ("pairwise", "solid"):
            cpu = self.run_json("batch", scene, "--contacts", contacts)
            device = self.run_json("batch", scene, "--contacts", contacts, "--backend", "opencl")
            # Some pairs of solids, aligned boxes among them, are left to the CPU.
            self.assertIn(device["backend"], ("opencl",) if contacts == "pairwise" else ("opencl", "cpu and opencl"))
            for key in ("hash", "per_pair_contacts", "intersecting_pairs", "contacts_before_reduction"):
                self.assertEqual(cpu[key], device[key])
            self.assertGreater(cpu["total_contacts"], 20)
        arguments = ["collide", self.path("lump.ply"), self.path("box.ply"), "--pose", "0.9,0.1,0.2,1,0,0,0"]
        cpu, device = self.run_json(*arguments), self.run_json(*arguments, "--backend", "opencl")
        self.assertEqual((cpu["hash"], cpu["contacts"]), (device["hash"], device["contacts"]))
        self.assert_keys(device["timings_ms"], "build middle near contacts reduction transfer total top host")
        for backend in ("cpu", "opencl"):
            self.run_otg("pairs", *arguments[1:], "--out", self.path(backend), "--backend", backend)
        with open(self.path("cpu")) as cpu, open(self.path("opencl")) as device:
            self.assertEqual(cpu.read(), device.read())

    def test_threads_and_several_devices(self):
        scene = self.writeScene()
        expected = self.run_json("batch", scene, "--contacts", "pairwise", "--threads", "1")
        self.assertIn("1 threads", expected["device"])
        self.assertEqual(expected["pairs_on_devices"], 0)
        runs = [["--threads", "4"], ["--backend", "auto"]]
        if self.hasDevice():
            runs += [["--backend", "opencl", "--device", "0,0,0"], ["--nearphase", "opencl"], ["--midphase", "opencl"]]
        for options in runs:
            document = self.run_json("batch", scene, "--contacts", "pairwise", *options) if "phase" not in options[0] \
                else None
            if document is not None:
                for key in ("hash", "per_pair_contacts", "intersecting_pairs", "contacts_before_reduction"):
                    self.assertEqual(document[key], expected[key], options)
                if "0,0,0" in options:
                    self.assertEqual(document["pairs_on_devices"], 16)
                    self.assertEqual(sum(device["block_pairs"] for device in document["devices"]), 16)
                    self.assertTrue(all(d["ms"] > 0 for d in document["devices"] if d["block_pairs"] > 0))
            mesh, other = self.path("lump.ply"), self.path("box.ply")
            if "--threads" in options:
                continue
            pair = ["collide", mesh, other, "--pose", "0.9,0.1,0.2,1,0,0,0"]
            one = [word.split(",")[0] for word in options]
            cpu, mixed = self.run_json(*pair), self.run_json(*pair, *one)
            self.assertEqual((cpu["hash"], cpu["contacts"]), (mixed["hash"], mixed["contacts"]))
            if "phase" in options[0]:
                self.assertEqual(mixed["backend"], "opencl")
                self.assertEqual((mixed["midphase"] == "opencl", mixed["nearphase"] == "opencl"),
                                 (options[0] == "--midphase", options[0] == "--nearphase"))
            self.run_otg("pairs", *pair[1:], "--out", self.path("some"), *one)
            self.run_otg("pairs", *pair[1:], "--out", self.path("same"))
            with open(self.path("some")) as some, open(self.path("same")) as same:
                self.assertEqual(some.read(), same.read())

    def test_costs_are_measured_where_they_count(self):
        """Not for equal devices that have to do all; where they are known they are used."""
        if not self.hasDevice():
            self.skipTest("no OpenCL device")
        scene, cache = self.writeScene(), {"OTG_CACHE_DIR": self.path("cache")}
        os.mkdir(self.path("cache"))
        self.run_json("batch", scene, "--contacts", "pairwise", "--backend", "opencl")
        for file in self.cacheFiles():  # the programs alone, which take long to build
            with open(file, "rb") as content:
                if b"otgcost" not in content.read():
                    shutil.copy(file, self.path("cache"))

        def expectations(*options):
            document = self.run_json("batch", scene, "--contacts", "pairwise", *options, env=cache)
            self.assertEqual(document["hash"], self.run_json("batch", scene, "--contacts", "pairwise")["hash"])
            return [(d["expected_ms"], d["block_pairs"]) for d in document["devices"]]
        blocks = expectations("--backend", "opencl", "--device", "0,0")
        self.assertEqual([ms for ms, _ in blocks], [None, None])
        self.assertTrue(all(pairs > 0 for _, pairs in blocks))
        self.assertEqual(len(expectations("--backend", "auto", "--device", "0")), 1)
        blocks = expectations("--backend", "opencl", "--device", "0,0")
        self.assertTrue(all(ms > 0 and pairs > 0 for ms, pairs in blocks), blocks)

    def test_without_a_device(self):
        scene = self.writeScene()
        expected = self.run_json("batch", scene)
        result = self.run_otg("batch", scene, "--backend", "opencl", "--json", env={"OTG_OPENCL_DEVICE": "none"})
        found = json.loads(result.stdout)
        for key in ("hash", "per_pair_contacts", "backend", "device"):
            self.assertEqual(found[key], expected[key])
        self.assertEqual((result.stderr.count("\n"), "no OpenCL device" in result.stderr), (1, True), result.stderr)
        self.assert_fails(1, "batch", scene, "--backend", "opencl", "--device", "0,99", says="99")

    def test_bad_scenes(self):
        for changes, says in (({"meshes": 3}, "meshes"), ({"pairs": {}}, "pairs"), ({"bodies": []}, "bodies"),
                              ({"meshes": ["none.ply"]}, "none.ply"), ({"meshes": [1]}, "paths"),
                              ({"pairs": [[0, 2, self.POSES[0]]]}, "pairs[0]"),
                              ({"pairs": [[0, -1, self.POSES[0]]]}, "mesh"),
                              ({"pairs": [[0, 0]]}, "pairs[0]"), ({"pairs": [[0, 0, [1, 2]]]}, "pose"),
                              ({"pairs": [[0, 0, [0, 0, 0, 2, 0, 0, 0]]]}, "quaternion")):
            self.assert_fails(1, "batch", self.writeScene(**changes), says=says)
        self.assert_fails(1, "batch", self.write("text.json", "no json"), says="text.json")
        self.assert_fails(1, "batch", self.path("missing.json"), says="missing.json")

    def test_broken_json_says_where(self):
        self.assert_fails(1, "batch", self.write("scene.json", '{"meshes": [],\n "pairs": [[0, 0, [1, 2,]]]}'),
                          says=("scene.json", "line 2, column"))


class Devices(CliTest):
    def test_list(self):
        document = self.run_json("devices")
        for i, device in enumerate(document["devices"]):
            self.assert_keys(device, "index name kind platform version driver available doubles used")
            self.assertEqual(device["index"], i)
            self.assertEqual(device["used"], i == document["used"])
        text = self.run_otg("devices").stdout
        for device in document["devices"]:
            self.assertIn(device["name"], text)
        if document["used"] is not None:
            self.assertIn("--backend opencl uses device %d" % document["used"], text)
            self.assertIn("None of them is used: OTG_OPENCL_DEVICE",
                          self.run_otg("devices", env={"OTG_OPENCL_DEVICE": "none"}).stdout)

    def test_choice(self):
        self.assertIsNone(self.run_json("devices", env={"OTG_OPENCL_DEVICE": "none"})["used"])
        if self.run_json("devices")["devices"]:
            self.assertEqual(self.run_json("devices", env={"OTG_OPENCL_DEVICE": "0"})["used"], 0)

    def test_without_drivers(self):
        # The loader finds drivers through this folder; an empty one is a machine without OpenCL.
        document = self.run_json("devices", env={"OCL_ICD_VENDORS": self.folder, "OPENCL_VENDOR_PATH": self.folder})
        self.assertEqual((document["devices"], document["used"]), ([], None))
        nothing = self.run_otg("devices", env={"OCL_ICD_VENDORS": self.folder, "OPENCL_VENDOR_PATH": self.folder})
        self.assertTrue(nothing.stdout.startswith("no OpenCL device: everything runs on the CPU\n"))


if __name__ == "__main__":
    cli_support.main()
