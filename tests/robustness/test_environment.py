# SPDX-License-Identifier: BSD-3-Clause
"""Environment variables with values that are not allowed: one line on stderr each, whatever program it is.

python3 test_environment.py OTG PRELOAD_LIBRARY STACK, the latter a program that knows nothing of this library."""
import json
import os
import subprocess
import sys
import unittest


def run(program, **variables):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("OTG_")}
    environment["OTG_CACHE_DIR"] = ""
    environment.update(variables)
    return subprocess.run(program, env=environment, capture_output=True, text=True, timeout=300)


def stack(**variables):
    return run([STACK, "3", "30"], LD_PRELOAD=PRELOAD, **variables)


def own_lines(result):
    return [line for line in result.stderr.splitlines() if line.startswith("ode_trimesh_gpu: ")]


def numbers(result):
    found = json.loads(result.stdout)
    return {key: value for key, value in found.items() if not key.startswith(("ms_", "collide_ms"))}


WRONG = {"OTG_BACKEND": ("cuda", "auto, cpu, opencl"), "OTG_DEVICE_MEMORY": ("abc", "bytes"),
         "OTG_THREADS": ("many", "1 to 1024"), "OTG_PRELOAD": ("maybe", "off"),
         "OTG_PRELOAD_CONTACTS": ("bogus", "solid, pairwise"), "OTG_PRELOAD_MAX_CONTACTS": ("-4", "1 to 65535"),
         "OTG_PRELOAD_CONTACTS_PER_REGION": ("65", "1 to 64"), "OTG_PRELOAD_PRIMITIVES": ("cone", "heightfield"),
         "OTG_PRELOAD_JOIN": ("perhaps", "off"), "OTG_PRELOAD_VERBOSE": ("loud", "off")}


class Wrong(unittest.TestCase):
    def check(self, result, names):
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = own_lines(result)
        self.assertEqual(len(lines), len(names), result.stderr)
        for name in names:
            value, allowed = WRONG[name]
            mine = [line for line in lines if "%s=%s " % (name, value) in line]
            self.assertEqual(len(mine), 1, result.stderr)
            self.assertIn(allowed, mine[0])

    def test_each_under_the_preload_library(self):
        right = numbers(stack())
        for name, (value, _) in WRONG.items():
            result = stack(**{name: value})
            self.check(result, [name])
            self.assertEqual(numbers(result), right, name)

    def test_all_at_once(self):
        everything = {name: value for name, (value, _) in WRONG.items()}
        self.check(stack(**everything), list(WRONG))
        self.check(run([OTG, "devices"], **everything), list(WRONG))

    def test_a_device_that_is_not_there(self):
        result = run([OTG, "devices"], OTG_OPENCL_DEVICE="nosuch")
        lines = own_lines(result)
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertIn("OTG_OPENCL_DEVICE=nosuch", lines[0])
        self.assertIn("none", lines[0])
        self.assertEqual(own_lines(run([OTG, "devices"], OTG_OPENCL_DEVICE="none")), [])
        # Whoever asks for a device by the environment hears that there is none.
        lines = own_lines(stack(OTG_OPENCL_DEVICE="none", OTG_BACKEND="opencl"))
        self.assertEqual(len(lines), 1)
        self.assertIn("no OpenCL device", lines[0])


class Switches(unittest.TestCase):
    def test_off_in_every_way(self):
        without = numbers(run([STACK, "3", "30"]))
        for word in ("off", "0", "no", "false", "OFF"):
            result = stack(OTG_PRELOAD=word)
            self.assertEqual(numbers(result), without, word)
            self.assertEqual(own_lines(result), [])
        for word in ("on", "1", "yes", "true", ""):
            self.assertNotEqual(numbers(stack(OTG_PRELOAD=word)), without, word)

    def test_verbose_in_every_way(self):
        for word in ("1", "on", "yes", "true"):
            self.assertEqual(len(own_lines(stack(OTG_PRELOAD_VERBOSE=word))), 2, word)
        for word in ("0", "off", "no", ""):
            self.assertEqual(own_lines(stack(OTG_PRELOAD_VERBOSE=word)), [], word)


if __name__ == "__main__":
    STACK = sys.argv.pop()
    PRELOAD = sys.argv.pop()
    OTG = sys.argv.pop()
    unittest.main()
