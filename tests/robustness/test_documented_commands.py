# SPDX-License-Identifier: BSD-3-Clause
"""Command lines in README.md and docs/: their commands, options and scripts exist.

Lines of the manual are begun, on the CPU; what takes longer than LIMIT seconds is ended then. Those of docs/lab/ and
docs/results/, which need hours, files or a GPU, are parsed. Run as: python3 test_documented_commands.py PATH_OF_OTG"""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
OTG = None
LIMIT = 2
PAGES = sorted([ROOT / "README.md", *ROOT.glob("docs/**/*.md")])
# A command stands in code: a line of a block, or between backticks.
COMMAND = re.compile(r"(?:^|[\s`])(?:build/bin/)?otg((?: [^\s`|]+)+)")


def lines_of_code(text):
    """(number of the line, code) for indented lines, fenced lines and what stands between backticks."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
        elif fenced or line.startswith("    "):
            yield number, line.split("  #")[0]
        else:
            for code in re.findall(r"`([^`]+)`", line):
                yield number, code


def commands():
    for page in PAGES:
        for number, code in lines_of_code(page.read_text()):
            for words in COMMAND.findall(code):
                yield "%s:%d" % (page.relative_to(ROOT), number), words.split()


TETRAHEDRON = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
"""


class Help:
    """What `otg ... --help` says, once for each command."""
    texts = {}

    @classmethod
    def of(cls, *command):
        if command not in cls.texts:
            run = subprocess.run([OTG, *command, "--help"], capture_output=True, text=True, timeout=60)
            cls.texts[command] = run.stdout if run.returncode == 0 else ""
        return cls.texts[command]


class DocumentedCommands(unittest.TestCase):
    def test_commands_and_options_exist(self):
        seen = 0
        for place, words in commands():
            name = words[:2] if words[0] == "bench" and len(words) > 1 and not words[1].startswith("-") else words[:1]
            if not re.fullmatch(r"[a-z]+", name[-1]):
                continue  # otg CMD, otg ...
            with self.subTest(place=place, command=" ".join(words)):
                text = Help.of(*name)
                self.assertNotEqual(text, "", "there is no such command")
                for option in re.findall(r"(?<![\w-])--?[a-z][\w-]*", " ".join(words[len(name):])):
                    self.assertRegex(text, r"(?<![\w-])%s(?![\w-])" % re.escape(option))
                seen += 1
        self.assertGreater(seen, 40)

    def test_whole_lines_parse(self):
        """Lines of blocks, as a reader copies them, with --help behind: nothing is run, but every word is read."""
        seen = 0
        for page in PAGES:
            text = page.read_text().replace("\\\n", " ")
            blocks = re.findall(r"(?m)^    (?:[A-Z_]+=\S+ )*build/bin/otg ([^#|>&\n]+)$", text)
            for line in blocks:
                with self.subTest(page=page.name, line=line):
                    run = subprocess.run([OTG, *line.split(), "--help"], capture_output=True, text=True, timeout=60)
                    self.assertEqual((run.returncode, run.stderr), (0, ""))
                seen += 1
        self.assertGreater(seen, 20)

    def test_lines_of_the_manual_run(self):
        """In a folder with the meshes that they name. A line that goes on is as good as one that has ended well."""
        seen = 0
        with tempfile.TemporaryDirectory() as folder:
            os.makedirs(os.path.join(folder, "build", "bin"))
            os.makedirs(os.path.join(folder, "out"))
            for name in (OTG, os.path.join(os.path.dirname(OTG), "otg_bench")):
                os.symlink(name, os.path.join(folder, "build", "bin", os.path.basename(name)))
            shutil.copytree(ROOT / "benchmarks" / "published", os.path.join(folder, "benchmarks", "published"))
            for name in ("mesh.ply", "other.ply"):
                pathlib.Path(folder, name).write_text(TETRAHEDRON)
            pathlib.Path(folder, "scene.json").write_text('{"bodies": [{"name": "ball", "sphere": 0.5}]}')
            environment = dict(os.environ, OTG_OPENCL_DEVICE="none", OTG_CACHE_DIR="")
            for page in [p for p in PAGES if p.parent in (ROOT, ROOT / "docs")]:
                blocks = re.findall(r"(?m)^    ((?:[A-Z_]+=\S+ )*)(build/bin/otg [^#|>\n]+)", page.read_text())
                for variables, line in blocks:
                    # Folders of meshes are the reader's own: without them benchmarks make theirs.
                    own = [v for v in variables.split() if not v.startswith("OTG_MESH_DIR=")]
                    with self.subTest(page=page.name, line=line):
                        run = subprocess.Popen(["bash", "-c", " ".join([*own, line])], cwd=folder, env=environment,
                                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                               start_new_session=True)
                        try:
                            errors = run.communicate(timeout=LIMIT)[1]
                            self.assertEqual(run.returncode, 0, errors)
                        except subprocess.TimeoutExpired:
                            os.killpg(run.pid, signal.SIGKILL)
                            run.communicate()
                    seen += 1
        self.assertGreater(seen, 10)

    def test_scripts_exist(self):
        seen = 0
        for page in PAGES:
            for name in re.findall(r"scripts/[\w./-]+\.(?:sh|py)", page.read_text()):
                seen += 1
                self.assertTrue((ROOT / name).is_file(), "%s names %s" % (page.relative_to(ROOT), name))
        self.assertGreater(seen, 5)


if __name__ == "__main__":
    OTG = os.path.abspath(sys.argv.pop(1))
    unittest.main()
