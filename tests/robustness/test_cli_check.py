# SPDX-License-Identifier: BSD-3-Clause
"""otg check, the common behaviour of the command line, and what happens to files that are no meshes."""
import json
import struct

import cli_support
from cli_support import CliTest, box, ply


class Usage(CliTest):
    def test_help_is_a_success(self):
        for arguments in (["--help"], ["check", "--help"]):
            self.assertIn("--help", self.run_otg(*arguments).stdout)

    def test_wrong_usage_is_2(self):
        mesh = self.writeBox()
        self.assert_fails(2)
        self.assert_fails(2, "frobnicate", says="'frobnicate' is no command")
        self.assert_fails(2, "bench", "frobnicate", says="'frobnicate' is no command")
        self.assert_fails(2, "check")
        self.assert_fails(2, "check", mesh, "--frobnicate", says="frobnicate")

    def test_the_nearest_word_is_named(self):
        mesh = self.writeBox()
        self.assert_fails(2, "colide", mesh, mesh, says=("'colide'", "did you mean 'collide'?"))
        self.assert_fails(2, "simulate", "--htlm", "page.html", says="did you mean '--html'?")
        self.assert_fails(2, "collide", mesh, mesh, "--contcts=solid",
                          says=("'--contcts'", "did you mean '--contacts'?"))
        self.assert_fails(2, "collide", mesh, mesh, "--jsn", "--repet", "3", says=("'--json'?", "'--repeat'?"))
        self.assert_fails(2, "bench", "phisics", says="did you mean 'physics'?")
        for words in (["frobnicate"], ["check"], ["check", mesh, "--frobnicate"]):
            self.assertNotIn("did you mean", self.run_otg(*words, status=2).stderr)


class Check(CliTest):
    KEYS = ("file vertices triangles edges closed manifold oriented degenerate_triangles duplicate_triangles "
            "nonfinite_vertices volume center_of_mass inertia valid problems")

    def test_box(self):
        mesh = self.write("b.ply", ply(*box(size=(1, 2, 4), center=(1, 0, 0))))
        row = self.run_json("check", mesh)
        self.assert_keys(row, self.KEYS + " class components bounds repair files")
        self.assertEqual(row["files"], [{key: value for key, value in row.items() if key != "files"}])
        self.assertEqual((row["vertices"], row["triangles"], row["edges"]), (8, 12, 18))
        for key in ("closed", "manifold", "oriented", "valid"):
            self.assertIs(row[key], True, key)
        self.assertEqual(row["problems"], [])
        self.assertEqual(row["class"], "solid")
        self.assertAlmostEqual(row["volume"], 8)
        for got, expected in zip(row["center_of_mass"], (1, 0, 0), strict=True):
            self.assertAlmostEqual(got, expected)
        # Mass 8 (density 1), sides 1, 2, 4: m (b^2 + c^2) / 12.
        for i, expected in enumerate((8 * 20 / 12, 8 * 17 / 12, 8 * 5 / 12)):
            self.assertAlmostEqual(row["inertia"][i][i], expected)

    def test_several_files(self):
        document = self.run_json("check", self.writeBox("a.ply"), self.writeBox("b.ply", size=(2, 2, 2)))
        self.assertEqual([row["file"] for row in document["files"]], [self.path("a.ply"), self.path("b.ply")])
        self.assertAlmostEqual(document["files"][1]["volume"], 8)
        self.assertNotIn("volume", document)

    def test_readable_output(self):
        self.assertIn("12 triangles", self.run_otg("check", self.writeBox()).stdout)

    def test_imperfect_meshes_are_reported_and_accepted(self):
        vertices, triangles = box()
        row = self.run_json("check", self.write("open.ply", ply(vertices, triangles[1:])))
        self.assertEqual((row["closed"], row["valid"], row["class"], row["boundary_edges"]), (False, False, "shell", 3))
        self.assertTrue(row["problems"])
        for problem in row["problems"]:
            self.assert_keys(problem, "kind count elements message")
        flipped = [triangles[0][::-1]] + triangles[1:]
        row = self.run_json("check", self.write("flipped.ply", ply(vertices, flipped)))
        self.assertEqual((row["oriented"], row["valid"]), (False, False))
        row = self.run_json("check", self.write("twice.ply", ply(vertices, triangles + triangles[:1])))
        self.assertEqual((row["duplicate_triangles"], row["valid"]), (1, False))
        row = self.run_json("check", self.write("thin.ply", ply(vertices, triangles + [(0, 0, 1)])))
        self.assertEqual((row["degenerate_triangles"], row["valid"]), (1, False))

    def test_repair(self):
        vertices, triangles = box()
        broken = [triangles[0][::-1]] + triangles[1:] + triangles[3:4] + [(2, 2, 5)]
        path = self.write("broken.ply", ply(vertices, broken))
        self.assertFalse(self.run_json("check", path)["valid"])
        row = self.run_json("check", path, "--repair")
        self.assertTrue(row["valid"])
        self.assertEqual(row["triangles"], 12)
        self.assertEqual((row["repair"]["dropped_degenerate"], row["repair"]["dropped_duplicates"],
                          row["repair"]["flipped_triangles"]), (1, 1, 1))
        self.assertAlmostEqual(row["volume"], 1)

    def test_refused_meshes(self):
        vertices, triangles = box()
        path = self.write("nan.ply", ply([(float("nan"), 0, 0)] + vertices[1:], triangles))
        self.assert_fails(1, "check", path, "--json", says=["nan.ply"])
        row = self.run_json("check", path, status=1)
        self.assert_keys(row, self.KEYS)
        self.assertEqual((row["nonfinite_vertices"], row["valid"], row["volume"]), (1, False, None))
        self.assertEqual((row["vertices"], row["triangles"]), (8, 12))
        path = self.write("index.ply", ply(vertices, triangles[:-1] + [(0, 1, 8)]))
        self.assert_fails(1, "check", path, "--json", says=["index.ply"])
        row = self.run_json("check", path, status=1)
        self.assertIs(row["valid"], False)
        self.assertEqual([p["elements"] for p in row["problems"]], [[11]])
        path = self.write("negative.ply", ply(vertices, [(0, 1, -1)] + triangles[1:]))
        self.assertIs(self.run_json("check", path, status=1)["valid"], False)

    def test_a_bad_file_does_not_hide_the_others(self):
        document = self.run_json("check", "missing.ply", self.writeBox(), status=1)
        self.assertEqual([row["valid"] for row in document["files"]], [False, True])


class BadFiles(CliTest):
    def test_missing_folder_empty(self):
        self.assert_fails(1, "check", "nothing.ply", says=["nothing.ply", "no such file"])
        self.assert_fails(1, "check", self.folder, says=[self.folder, "folder"])
        self.assert_fails(1, "check", self.write("empty.ply", ""), says=["empty.ply", "empty"])

    def test_text_garbage(self):
        for name in ("g.ply", "g.off", "g.stl", "g.obj", "g.gltf", "g.glb", "g.xyzzy", "g"):
            path = self.write(name, "This is not a mesh.\nNot at all: 1 2 3\n" * 5)
            self.assert_fails(1, "check", path, says=name)

    def test_truncated_ply(self):
        whole = ply(*box())
        for length in range(1, len(whole), 7):
            self.assert_fails(1, "check", self.write("cut.ply", whole[:length]), says="cut.ply")
        text = ply(*box(), binary=False)
        lines = text.splitlines(keepends=True)
        for count in range(1, len(lines)):
            self.assert_fails(1, "check", self.write("cut.ply", b"".join(lines[:count])), says="cut.ply")

    def test_lying_headers(self):
        """Counts beyond the file must be found before memory is asked for."""
        for count in (9, 10**6, 2**31, 2**62, 2**63 - 1, -1):
            content = ply(*box()).replace(b"vertex 8", b"vertex %d" % count)
            self.assert_fails(1, "check", self.write("lie.ply", content), says="lie.ply")
            self.assert_fails(1, "check", self.write("lie.off", "OFF\n3 %d 0\n0 0 0\n1 0 0\n0 1 0\n" % count),
                              says="lie.off")
        self.assert_fails(1, "check", self.write("lie.stl", b"\0" * 80 + struct.pack("<I", 2**32 - 1)), says="lie.stl")

    def test_zero_bytes_inside(self):
        whole = bytearray(ply(*box()))
        for start in range(0, 200, 11):
            broken = bytearray(whole)
            broken[start:start + 9] = b"\0" * 9
            result = self.run_otg_any("check", self.write("zero.ply", bytes(broken)))
            self.assertIn(result, (0, 1))

    def run_otg_any(self, *arguments):
        import subprocess
        return subprocess.run([cli_support.OTG, *arguments], capture_output=True, timeout=60).returncode


class Formats(CliTest):
    """The same box in every format, with vertices shared or not."""

    def same_box(self, name, content):
        row = self.run_json("check", self.write(name, content))
        self.assertEqual((row["vertices"], row["triangles"], row["edges"], row["class"]), (8, 12, 18, "solid"), name)
        self.assertAlmostEqual(row["volume"], 1, msg=name)

    def test_formats(self):
        vertices, triangles = box()
        self.same_box("text.ply", ply(vertices, triangles, binary=False))
        self.same_box("box.off", "OFF\n8 12 0\n" + "".join("%g %g %g\n" % v for v in vertices) +
                      "".join("3 %d %d %d\n" % t for t in triangles))
        self.same_box("box.obj", "".join("v %g %g %g\n" % v for v in vertices) +
                      "".join("f %d %d %d\n" % tuple(i + 1 for i in t) for t in triangles))
        facets = [[vertices[i] for i in t] for t in triangles]
        self.same_box("text.stl", "solid box\n" + "".join(
            "facet normal 0 0 0\nouter loop\n%sendloop\nendfacet\n" % "".join("vertex %g %g %g\n" % v for v in f)
            for f in facets) + "endsolid box\n")
        self.same_box("binary.stl", b"solid, but binary".ljust(80) + struct.pack("<I", 12) + b"".join(
            struct.pack("<12fH", 0, 0, 0, *f[0], *f[1], *f[2], 0) for f in facets))
        self.write("box.bin", b"".join(struct.pack("<3f", *v) for v in vertices) +
                   b"".join(struct.pack("<3H", *t) for t in triangles))
        self.same_box("box.gltf", json.dumps({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "rotation": [0, 0, 1, 0]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{"uri": "box.bin", "byteLength": 168}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 96},
                            {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3",
                           "min": [-0.5] * 3, "max": [0.5] * 3},
                          {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]}))


if __name__ == "__main__":
    cli_support.main()
