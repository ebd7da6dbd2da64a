# SPDX-License-Identifier: BSD-3-Clause
"""otg pairs: the file, its order, and that triangle numbers are those of the input file in every format."""
import struct

import cli_support
from cli_support import CliTest, box, lump, ply


class Pairs(CliTest):
    POSE = ["--pose", "1.4,0.1,0.3,0.8,0,0.6,0"]

    def read(self, name):
        with open(self.path(name)) as file:
            return [tuple(map(int, line.split(" "))) for line in file.read().splitlines()]

    def test_sorted_pairs(self):
        mesh = self.write("lump.ply", ply(*lump()))
        document = self.run_json("pairs", mesh, mesh, *self.POSE, "--out", "pairs.txt")
        self.assert_keys(document, "candidate_pairs intersecting_pairs")
        pairs = self.read("pairs.txt")
        self.assertGreater(len(pairs), 10)
        self.assertEqual(document["intersecting_pairs"], len(pairs))
        self.assertGreaterEqual(document["candidate_pairs"], len(pairs))
        self.assertEqual(pairs, sorted(set(pairs)))
        text = self.run_otg("pairs", mesh, mesh, *self.POSE, "--out", "-").stdout
        with open(self.path("pairs.txt")) as file:
            self.assertEqual(text, file.read())

    def test_a_known_set(self):
        """One triangle through the middle of another."""
        flat = self.write("flat.ply", ply([(0, 0, 0), (4, 0, 0), (0, 4, 0)], [(0, 1, 2)]))
        both = self.write("both.ply", ply([(1, 1, -1), (1, 1, 1), (9, 9, 0), (5, 5, 5), (6, 5, 5), (5, 6, 5)],
                                          [(3, 4, 5), (0, 1, 2)]))
        self.run_otg("pairs", flat, both, "--pose", "0,0,0,1,0,0,0", "--out", "pairs.txt")
        self.assertEqual(self.read("pairs.txt"), [(0, 1)])
        self.run_otg("pairs", both, flat, "--pose", "0,0,0,1,0,0,0", "--out", "pairs.txt")
        self.assertEqual(self.read("pairs.txt"), [(1, 0)])

    def test_numbers_are_those_of_the_file(self):
        vertices, triangles = lump(10)
        vertices = [tuple(struct.unpack("<3f", struct.pack("<3f", *v))) for v in vertices]
        mesh = self.write("lump.ply", ply(vertices, triangles))
        self.run_otg("pairs", mesh, mesh, *self.POSE, "--out", "expected.txt")
        facets = [[vertices[i] for i in t] for t in triangles]
        others = {
            "text.ply": ply(vertices, triangles, binary=False),
            "lump.off": "OFF %d %d 0\n" % (len(vertices), len(triangles)) +
                        "".join("%r %r %r\n" % v for v in vertices) +
                        "".join("3 %d %d %d\n" % t for t in triangles),
            "lump.obj": "".join("v %r %r %r\n" % v for v in vertices) +
                        "".join("f %d %d %d\n" % tuple(i + 1 for i in t) for t in triangles),
            "lump.stl": b"\0" * 80 + struct.pack("<I", len(facets)) + b"".join(
                struct.pack("<12fH", 0, 0, 0, *f[0], *f[1], *f[2], 0) for f in facets)}
        for name, content in others.items():
            path = self.write(name, content)
            self.run_otg("pairs", path, path, *self.POSE, "--out", "pairs.txt")
            self.assertEqual(self.read("pairs.txt"), self.read("expected.txt"), name)

    def test_degenerate_triangles_keep_the_numbers(self):
        vertices, triangles = box()
        mesh = self.writeBox()
        bad = self.write("bad.ply", ply(vertices, [(0, 0, 1)] + triangles))
        self.run_otg("pairs", mesh, mesh, "--pose", "0.9,0.1,0.2,1,0,0,0", "--out", "expected.txt")
        self.run_otg("pairs", bad, bad, "--pose", "0.9,0.1,0.2,1,0,0,0", "--out", "pairs.txt")
        self.assertEqual(self.read("pairs.txt"), [(a + 1, b + 1) for a, b in self.read("expected.txt")])

    def test_apart_gives_an_empty_file(self):
        mesh = self.writeBox()
        self.run_otg("pairs", mesh, mesh, "--pose", "9,0,0,1,0,0,0", "--out", "pairs.txt")
        self.assertEqual(self.read("pairs.txt"), [])

    def test_levels_find_the_same(self):
        if self.run_json("devices")["used"] is None:
            self.skipTest("no OpenCL device")
        mesh = self.write("lump.ply", ply(*lump()))
        self.run_otg("pairs", mesh, mesh, *self.POSE, "--out", "expected.txt")
        self.run_otg("pairs", mesh, mesh, *self.POSE, "--midphase", "levels", "--out", "pairs.txt")
        self.assertEqual(self.read("pairs.txt"), self.read("expected.txt"))

    def test_bad_input(self):
        mesh = self.writeBox()
        self.assert_fails(1, "pairs", mesh, "missing.ply", "--out", "x.txt", says="missing.ply")
        self.assert_fails(1, "pairs", mesh, mesh, "--out", "no/such/folder/x.txt", says="no/such/folder/x.txt")
        self.assert_fails(2, "pairs", mesh, mesh, "--pose", "1,2", "--out", "x.txt", says="pose")
        self.assert_fails(2, "pairs", mesh, mesh, "--json", "--out", "-")
        self.assert_fails(2, "pairs", mesh, mesh, "--frobnicate")


if __name__ == "__main__":
    cli_support.main()
