# SPDX-License-Identifier: BSD-3-Clause
"""Files made to hurt: otg says what is wrong with them, ends with status 1, and takes little time and memory for it."""
import base64
import json
import os
import resource
import struct
import subprocess
import tempfile

import cli_support
from cli_support import CliTest, box, ply

MOST_SECONDS = 12  # of processor time: what works takes less than two, what grows without bound takes all of it
MOST_BYTES = 500e6


class HostileTest(CliTest):
    def answered(self, *arguments, limit=1):
        """Status 0 within the limits, `limit` times as much memory; what was on stdout."""
        with tempfile.TemporaryFile() as out:
            process = subprocess.Popen([cli_support.OTG, *arguments], stdout=out, cwd=self.folder, preexec_fn=lambda:
                                       resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS)))
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = status
            self.assertEqual(status, 0)
            out.seek(0)
            self.assertLess(usage.ru_maxrss * 1024, limit * MOST_BYTES)
            return json.load(out)

    def refused(self, *arguments, says=()):
        """Status 1, one reason on stderr, nothing on stdout, within the limits."""
        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS))
            resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            process = subprocess.Popen([cli_support.OTG, *arguments], stdout=out, stderr=err, cwd=self.folder,
                                       preexec_fn=limit)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = status
            err.seek(0)
            message = err.read().decode()
            out.seek(0)
            self.assertEqual(out.read(), b"")
        self.assertTrue(os.WIFEXITED(status), "%r ended with signal %d: %s" %
                        (arguments, os.WTERMSIG(status), message[-500:]))
        self.assertEqual(os.WEXITSTATUS(status), 1, message)
        self.assertTrue(message.startswith("otg: "), message)
        for word in [says] if isinstance(says, str) else says:
            self.assertIn(word, message)
        self.assertLess(usage.ru_maxrss * 1024, MOST_BYTES, message)


class MeshFiles(HostileTest):
    def test_ply_elements_without_properties(self):
        whole = ply(*box(), binary=False).decode()
        for count in (1, 10**9, 2**63 - 1):
            nothing = whole.replace("element vertex", "element nothing %d\nelement vertex" % count)
            result = subprocess.run([cli_support.OTG, "check", "--json", self.write("nothing.ply", nothing)],
                                    capture_output=True, timeout=30)
            row = json.loads(result.stdout)
            self.assertEqual((row["vertices"], row["triangles"]), (8, 12))
        for name in ("vertex", "face"):
            self.refused("check", self.write("bare.ply", "ply\nformat ascii 1.0\nelement %s %d\nend_header\n" %
                                             (name, 2**63 - 1)), says="bare.ply")

    def test_ply_lists_that_never_end(self):
        for kind in ("ascii", "binary_little_endian"):
            header = ("ply\nformat %s 1.0\nelement other 3\nproperty list uint uchar x\nelement vertex 0\n"
                      "property float x\nproperty float y\nproperty float z\nend_header\n" % kind)
            body = "4000000000 1 2 3" if kind == "ascii" else "\xff\xff\xff\x7f123"
            self.refused("check", self.write("list.ply", (header + body).encode("latin-1")), says="cut off")


TRIANGLE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)


def triangle_gltf(nodes, roots=(0,), **changes):
    """One triangle that nodes place."""
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(roots)}], "nodes": nodes,
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                               "min": [0, 0, 0], "max": [1, 1, 0]}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}],
                "buffers": [{"byteLength": 36,
                             "uri": "data:application/octet-stream;base64," + base64.b64encode(TRIANGLE).decode()}]}
    document.update(changes)
    return document


def binary_gltf(document, binary=b""):
    if binary:
        document = {**document, "buffers": [{"byteLength": len(binary)}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary:
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def chain(length):
    return [{"children": [i + 1]} for i in range(length - 1)] + [{"mesh": 0}]


class Gltf(HostileTest):
    def refused_both_ways(self, document, says):
        self.refused("check", self.write("bad.gltf", json.dumps(document)), says=["bad.gltf", says])
        self.refused("check", self.write("bad.glb", binary_gltf(document)), says=["bad.glb", says])

    def test_what_is_right_is_read(self):
        for nodes in ([{"mesh": 0}], chain(100), [{"mesh": 0, "children": [1, 2]}, {"mesh": 0}, {"mesh": 0}]):
            for name, content in (("a.gltf", json.dumps(triangle_gltf(nodes))),
                                  ("a.glb", binary_gltf(triangle_gltf(nodes), TRIANGLE))):
                row = self.run_json("check", self.write(name, content))
                self.assertEqual(row["triangles"], sum("mesh" in node for node in nodes))

    def test_long_chains(self):
        for length in (600, 20000, 200000):
            self.refused_both_ways(triangle_gltf(chain(length)), "deep")

    def test_shared_children(self):
        nodes = [{"children": [i + 1, i + 1]} for i in range(29)] + [{"mesh": 0}]
        self.refused_both_ways(triangle_gltf(nodes), "parent")
        nodes = [{"children": [i + 1, i + 2]} for i in range(28)] + [{"mesh": 0}, {"mesh": 0}]
        self.refused_both_ways(triangle_gltf(nodes), "parent")

    def test_circles(self):
        self.refused_both_ways(triangle_gltf([{"children": [0], "mesh": 0}]), "circle")
        self.refused_both_ways(triangle_gltf([{"mesh": 0}, {"children": [2]}, {"children": [1]}]), "circle")

    def test_numbers_that_point_nowhere(self):
        for nodes in ([{"mesh": 1}], [{"mesh": -1}], [{"children": [7]}], [{"children": [-1]}], [{"mesh": 2**40}],
                      [{"children": "all"}], [{"mesh": 0.5}], [7]):
            self.refused_both_ways(triangle_gltf(nodes), "node")
        self.refused_both_ways(triangle_gltf([{"mesh": 0}], roots=[3]), "scene")
        self.refused_both_ways(triangle_gltf([{"mesh": 0}], scene=5), "scene")

    def test_counts_beyond_the_data(self):
        accessor = triangle_gltf([])["accessors"][0]
        for change in ({"count": 10**9}, {"count": -3}, {"count": 4}, {"byteOffset": 12}, {"componentType": 77},
                       {"type": "MAT99"}, {"bufferView": 9}, {"bufferView": None, "count": 10**9},
                       {"sparse": {"count": 10**9}}):
            self.refused_both_ways(triangle_gltf([{"mesh": 0}], accessors=[{**accessor, **change}]), "accessor")
        for view in ({"buffer": 0, "byteLength": 10**12}, {"buffer": 1, "byteLength": 36},
                     {"buffer": 0, "byteLength": 36, "byteOffset": 1}, {"buffer": 0}):
            self.refused_both_ways(triangle_gltf([{"mesh": 0}], bufferViews=[view]), "bufferView")
        for buffer in ({"byteLength": 10**12}, {"byteLength": 36, "uri": "missing.bin"},
                       {"byteLength": 10**12, "uri": "data:application/octet-stream;base64,AAAA"},
                       {"byteLength": 36, "uri": "/dev/zero"}):
            self.refused_both_ways(triangle_gltf([{"mesh": 0}], buffers=[buffer]), "buffer")

    def test_one_mesh_placed_very_often(self):
        count = 60000
        mesh = {"primitives": [{"attributes": {"POSITION": 0}}] * 2000}
        nodes = [{"children": list(range(1, count))}] + [{"mesh": 0}] * (count - 1)
        self.refused_both_ways(triangle_gltf(nodes, meshes=[mesh]), "so often")

    def test_brackets_in_brackets(self):
        text = json.dumps(triangle_gltf([{"mesh": 0}], extras=1)).replace('"extras": 1', '"extras": ' + "[" * 100000 +
                                                                          "]" * 100000)
        self.refused("check", self.write("deep.gltf", text), says="deep")

    def test_the_first_version_is_not_read(self):
        self.refused_both_ways(triangle_gltf([{"mesh": 0}], asset={"version": "1.0"}), "2.0")


class Scenes(HostileTest):
    def scene(self, **content):
        two = [{"name": "a", "sphere": 0.5}, {"name": "b", "box": [1, 2, 3], "position": [10, 0, 0]}]
        return self.write("scene.json", json.dumps({"bodies": two, **content}))

    def test_positions(self):
        for space in ("hash", "simple", "sap", "quadtree"):
            for place in (1e10, -1e10, 1e300):
                for axis in range(3):
                    position = [0, 0, 0]
                    position[axis] = place
                    path = self.scene(space=space, bodies=[{"name": "a", "sphere": 0.5, "position": position},
                                                           {"name": "b", "sphere": 0.5}])
                    self.refused("simulate", path, says=["scene.json", "position"])

    def test_the_farthest_places_are_all_right(self):
        path = self.scene(steps=3, bodies=[{"name": "a", "sphere": 0.001, "position": [1e8, -1e8, 1e8]},
                                           {"name": "b", "sphere": 0.5}], gravity=[0, 0, 0])
        self.assertEqual(self.run_json("simulate", path)["bodies"][0]["position"], [1e8, -1e8, 1e8])

    def test_a_long_free_fall(self):
        for space in ("hash", "sap"):
            self.refused("simulate", self.scene(steps=30000, dt=1, space=space), says=["'a'", "step", "1e+08"])

    def test_meshes_far_from_their_own_origin(self):
        self.write("far.ply", ply(*box(center=(1e10, 0, 0)), binary=False))
        self.refused("simulate", self.scene(meshes={"m": {"file": "far.ply"}},
                                            bodies=[{"name": "a", "mesh": "m", "static": True},
                                                    {"name": "b", "sphere": 0.5}]), says="'a'")

    def test_a_number_that_no_double_is(self):
        self.refused("simulate", self.write("number.json", '{"dt": 3e333, "bodies": []}'), says=["number.json", "JSON"])

    def test_speeds_and_gravity(self):
        self.refused("simulate", self.scene(gravity=[0, 0, -1e300]), says="gravity")
        for key in ("linear_velocity", "angular_velocity"):
            bodies = [{"name": "a", "box": [1, 2, 3], key: [1e200, 1e200, 0]}]
            self.refused("simulate", self.scene(bodies=bodies), says=key)

    def test_brackets_in_brackets(self):
        self.refused("simulate", self.write("deep.json", '{"bodies": ' + "[" * 300000 + "]" * 300000 + "}"),
                     says="deep.json")


class Copies(HostileTest):
    """Every triangle of one mesh on every triangle of the other."""

    def test_two_thousand_on_two_thousand(self):
        vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        one = self.write("one.ply", ply(vertices, [(0, 1, 2)]))
        many = self.write("many.ply", ply(vertices, [(0, 1, 2)] * 2000))
        pose = ["--pose", "0.1,0.1,0,1,0,0,0", "--json"]
        single, all_of_them = self.run_json("collide", one, one, *pose[:2]), self.answered("collide", many, many, *pose)
        self.assertEqual(all_of_them["intersecting_pairs"], 2000 * 2000)
        self.assertEqual(all_of_them["contacts"], single["contacts"])
        # The published model has contacts of each pair.
        pairwise = self.answered("collide", many, many, *pose, "--contacts", "pairwise", limit=2)
        self.assertEqual(pairwise["contacts_before_reduction"], 2000 * 2000)

    def test_more_pairs_than_a_query_may_have(self):
        vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        many = self.write("many.ply", ply(vertices, [(0, 1, 2)] * 5000))
        for contacts in ("solid", "pairwise"):
            self.refused("collide", many, many, "--contacts", contacts, says="more than 16777216 pairs")
        few = self.write("few.ply", ply(vertices, [(0, 1, 2)] * 20))
        self.refused("collide", few, few, "--max-pairs", "399", says="more than 399 pairs")
        self.answered("collide", few, few, "--max-pairs", "400", "--json")
        scene = self.write("scene.json", json.dumps({"meshes": ["few.ply"], "pairs": [[0, 0, [0, 0, 0, 1, 0, 0, 0]]]}))
        self.refused("batch", scene, "--max-pairs", "399", says=["scene.json", "pair 0"])


if __name__ == "__main__":
    cli_support.main()
