# SPDX-License-Identifier: BSD-3-Clause
"""otg bench is the program otg_bench beside otg: what otg hands over to it, and what it says where there is none."""
import os
import shutil
import subprocess

import cli_support
from cli_support import CliTest

# A stand-in for otg_bench: tells its words, and ends with a status that otg itself never has.
STAND_IN = """#!/bin/sh
printf '[%s]' "$@"
echo "and this on stderr" >&2
exit 7
"""


class HandOver(CliTest):
    def run_copy(self, *arguments, folder="bin"):
        """Runs a copy of otg in a folder of its own."""
        copy = os.path.join(self.folder, folder, "otg")
        if not os.path.exists(copy):
            os.makedirs(os.path.dirname(copy), exist_ok=True)
            shutil.copy(cli_support.OTG, copy)
        return subprocess.run([copy, *arguments], capture_output=True, cwd=self.folder, timeout=60, text=True)

    def stand_in(self, mode=0o755):
        os.chmod(self.write("bin/otg_bench", STAND_IN), mode)

    def setUp(self):
        super().setUp()
        os.mkdir(self.path("bin"))

    def test_bench_is_listed(self):
        self.assertRegex(self.run_otg("--help").stdout, r"\n  bench +Measure")

    def test_without_it(self):
        for arguments in (["bench"], ["bench", "peers", "--json"], ["bench", "--help"], ["--help", "bench"]):
            done = self.run_copy(*arguments)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertEqual(done.stderr, "otg: otg bench needs otg_bench: "
                                          "cmake --build --preset default --target otg_bench\n")

    def test_words_output_and_status_pass_through(self):
        self.stand_in()
        for given, received in ((["bench", "peers", "--json"], "[peers][--json]"),
                                (["bench", "a b", "", "--x=*"], "[a b][][--x=*]"),
                                (["bench", "bench", "check"], "[bench][check]"),
                                (["--help", "bench", "thesis"], "[--help][thesis]"),
                                (["bench"], "[]")):
            done = self.run_copy(*given)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (7, received, "and this on stderr\n"))

    def test_other_commands_stay(self):
        self.stand_in()
        self.assertEqual(self.run_copy("check", "bench").returncode, 1)  # a file of that name, which there is not
        self.assertEqual(self.run_copy("--help").returncode, 0)

    def test_found_from_the_search_path_and_through_links(self):
        self.stand_in()
        self.run_copy("--help")
        os.mkdir(self.path("links"))
        os.symlink(self.path("bin/otg"), self.path("links/otg"))
        for folder in ("bin", "links"):
            done = subprocess.run(["otg", "bench", "x"], capture_output=True, cwd=self.folder, timeout=60, text=True,
                                  env={**os.environ, "PATH": self.path(folder) + os.pathsep + os.environ["PATH"]})
            self.assertEqual((done.returncode, done.stdout), (7, "[x]"))

    def test_one_that_cannot_be_run(self):
        self.stand_in(mode=0o644)
        done = self.run_copy("bench", "peers")
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("Permission denied", done.stderr)


if __name__ == "__main__":
    cli_support.main()
