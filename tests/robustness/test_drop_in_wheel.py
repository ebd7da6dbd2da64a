# SPDX-License-Identifier: BSD-3-Clause
"""One of ODE's shapes on a road that is a dTriMesh, in a program that knows nothing of this library.

python3 test_drop_in_wheel.py PRELOAD_LIBRARY PROGRAM SHAPE"""
import json
import os
import subprocess
import sys


def run(program, shape, square, preload=None, **more):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("OTG_PRELOAD")}
    if preload:
        environment["LD_PRELOAD"] = preload
    environment.update(more)
    result = subprocess.run([program, shape, "40", square, "720"], env=environment, capture_output=True, text=True,
                            timeout=300)
    if result.returncode != 0:
        sys.exit("FAILED: %s" % result.stderr)
    numbers = {k: v for k, v in json.loads(result.stdout).items() if not k.endswith("_ms")}
    return numbers, [line for line in result.stderr.splitlines() if "ode_trimesh_gpu" in line]


def check(condition, message, *found):
    if not condition:
        sys.exit("FAILED: %s %s" % (message, found))


def main():
    preload, program, shape = sys.argv[1:]
    plane, _ = run(program, shape, "0")
    stock, _ = run(program, shape, "0.25")
    untouched, silent = run(program, shape, "0.25", preload)
    check(untouched == stock, "primitives are taken over without being asked for", untouched, stock)
    check(not silent, "it prints", silent)
    ours, lines = run(program, shape, "0.25", preload, OTG_PRELOAD_PRIMITIVES=shape + ",nonsense",
                      OTG_PRELOAD_VERBOSE="1")
    check(ours != stock, "nothing changed", ours)
    check(any("OTG_PRELOAD_PRIMITIVES=nonsense" in line for line in lines), "a name that is none is not reported",
          lines)
    check(not lines[-1].split(": ")[1].startswith("0 "), "no pair came through the library", lines)
    everything, _ = run(program, shape, "0.25", preload, OTG_PRELOAD_PRIMITIVES="all")
    check(everything == ours, "all is not each", everything, ours)
    check(abs(ours["way_m"] - plane["way_m"]) < 2e-3, "it does not go as on a plane", ours, plane)
    check(ours["bumps_m"] < 1e-6 and ours["aside_m"] < 1e-3, "it is not level or not straight", ours)
    print(plane, stock, ours, sep="\n")


main()
