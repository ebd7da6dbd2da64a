# SPDX-License-Identifier: BSD-3-Clause
"""Running otg, and small meshes for it. Each test file is run as: python3 test_cli_X.py PATH_OF_OTG"""
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest

OTG = None

BOX_VERTICES = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
# Corner i has bit 2 for x, bit 1 for y, bit 0 for z; counter-clockwise from outside.
BOX_TRIANGLES = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
                 (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]


def ply(vertices, triangles, binary=True):
    header = ("ply\nformat %s 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
              "element face %d\nproperty list uchar int vertex_indices\nend_header\n"
              % ("binary_little_endian" if binary else "ascii", len(vertices), len(triangles))).encode()
    if binary:
        return (header + b"".join(struct.pack("<3f", *v) for v in vertices) +
                b"".join(struct.pack("<B3i", 3, *t) for t in triangles))
    return (header + "".join("%r %r %r\n" % tuple(v) for v in vertices).encode() +
            "".join("3 %d %d %d\n" % tuple(t) for t in triangles).encode())


def box(size=(1, 1, 1), center=(0, 0, 0)):
    vertices = [tuple(c + s * x for c, s, x in zip(center, size, v, strict=True)) for v in BOX_VERTICES]
    return vertices, list(BOX_TRIANGLES)


def lump(n=24):
    """A closed bumpy surface: a grid on the sphere with poles."""
    vertices, triangles = [(0.0, 0.0, 1.0)], []
    for i in range(1, n):
        for j in range(2 * n):
            a, b = math.pi * i / n, math.pi * j / n
            r = 1 + 0.2 * math.sin(5 * a) * math.sin(3 * b)
            vertices.append((r * math.sin(a) * math.cos(b), r * math.sin(a) * math.sin(b), r * math.cos(a)))
    vertices.append((0.0, 0.0, -1.0))

    def at(i, j):
        return 1 + (i - 1) * 2 * n + j % (2 * n)

    for j in range(2 * n):
        triangles.append((0, at(1, j), at(1, j + 1)))
        for i in range(1, n - 1):
            triangles.append((at(i, j), at(i + 1, j), at(i + 1, j + 1)))
            triangles.append((at(i, j), at(i + 1, j + 1), at(i, j + 1)))
        triangles.append((at(n - 1, j), len(vertices) - 1, at(n - 1, j + 1)))
    return vertices, triangles


class CliTest(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path(name)

    def writeBox(self, name="box.ply", **keywords):
        return self.write(name, ply(*box(**keywords)))

    def run_otg(self, *arguments, status=0, env=None):
        result = subprocess.run([OTG, *arguments], capture_output=True, cwd=self.folder, timeout=500,
                                env={**os.environ, **(env or {})})
        result.stdout, result.stderr = result.stdout.decode(), result.stderr.decode()
        self.assertEqual(result.returncode, status, "%r\nstdout: %s\nstderr: %s" %
                         (arguments, result.stdout[-2000:], result.stderr[-2000:]))
        return result

    def run_json(self, *arguments, status=0, env=None):
        """stdout has to be one JSON document and nothing else; NaN and Infinity are not JSON."""
        def refuse(word):
            raise AssertionError("not JSON: " + word)
        return json.loads(self.run_otg(*arguments, "--json", status=status, env=env).stdout, parse_constant=refuse)

    def assert_fails(self, status, *arguments, says=()):
        """Exit status, silence on stdout (unless JSON was asked for), and every word of `says` on stderr."""
        result = self.run_otg(*arguments, status=status)
        if "--json" not in arguments:
            self.assertEqual(result.stdout, "")
        for word in [says] if isinstance(says, str) else says:
            self.assertIn(word, result.stderr)
        return result

    def assert_keys(self, document, keys):
        self.assertEqual([key for key in keys.split() if key not in document], [])


def main():
    global OTG
    OTG = os.path.abspath(sys.argv.pop(1))
    unittest.main(module="__main__")
