# SPDX-License-Identifier: BSD-3-Clause
"""Programs that know nothing of this library, without and with the preloadable one before them.

python3 test_drop_in.py PRELOAD_LIBRARY PROGRAM...
Exit status 77, with a message, where what a program needs is not installed."""
import json
import os
import subprocess
import sys

HELD = {"drift_m": 0.02, "tilt_deg": 0.5, "height_error_m": 0.01}


def run(program, preload, **more):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("OTG_PRELOAD")}
    if preload:
        environment["LD_PRELOAD"] = preload
    environment.update(more)
    return subprocess.run(program, env=environment, capture_output=True, text=True, timeout=300)


def own_lines(result):
    return [line for line in result.stderr.splitlines() if "ode_trimesh_gpu" in line]


def check(condition, message, *results):
    if not condition:
        print("FAILED:", message)
        for result in results:
            print(result.args, result.returncode, result.stdout, result.stderr, sep="\n")
        sys.exit(1)


def main():
    preload, program = sys.argv[1], sys.argv[2:]
    plain = run(program, None)
    if plain.returncode == 77 or "Trimesh support is disabled" in plain.stderr:
        print("skipped:", plain.stderr.strip().splitlines()[-1])
        sys.exit(77)
    check(plain.returncode == 0, "the program does not run as it is", plain)
    quiet = run(program, preload)
    loud = run(program, preload, OTG_PRELOAD_VERBOSE="1")
    off = run(program, preload, OTG_PRELOAD="off", OTG_PRELOAD_VERBOSE="1")
    for result in (quiet, loud, off):
        check(result.returncode == 0, "it does not run with the library", result)

    check(not own_lines(quiet), "the library prints without being asked", quiet)
    check(len(own_lines(loud)) == 2, "it does not say what it does when asked", loud)
    said = own_lines(loud)[1]
    check(" pairs of dTriMesh collided with " in said and not said.split(": ")[1].startswith("0 "),
          "no pair came through the library", loud)
    check(not own_lines(off), "it is not off", off)

    def numbers(result):
        found = json.loads(result.stdout)
        return {key: value for key, value in found.items() if not key.startswith(("ms_", "collide_ms"))}

    check(numbers(quiet) == numbers(loud), "two runs differ", quiet, loud)
    check(numbers(off) == numbers(plain), "off is not as without", off, plain)
    check(numbers(quiet) != numbers(plain), "nothing changed", quiet, plain)
    for key, limit in HELD.items():
        check(numbers(quiet)[key] < limit, "the stack does not stand: " + key, quiet)
    print("without:", plain.stdout, "with:", quiet.stdout, sep="\n")


main()
