# SPDX-License-Identifier: BSD-3-Clause
"""A ball on a road of dTriMesh slabs, in a program that knows nothing of this library.

python3 test_drop_in_road.py PRELOAD_LIBRARY PROGRAM"""
import json
import os
import subprocess
import sys


def run(program, slabs, preload=None, how="still", **more):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("OTG_PRELOAD")}
    if preload:
        environment["LD_PRELOAD"] = preload
        environment["OTG_PRELOAD_PRIMITIVES"] = "sphere"
    environment.update(more)
    result = subprocess.run([program, str(slabs), how], env=environment, capture_output=True, text=True, timeout=300)
    if result.returncode != 0:
        sys.exit("FAILED: %s" % result.stderr)
    return json.loads(result.stdout)


def check(condition, message, *found):
    if not condition:
        sys.exit("FAILED: %s %s" % (message, found))


def main():
    preload, program = sys.argv[1:]
    one = run(program, 1, preload)
    for slabs in (2, 8, 20, 64):
        many = run(program, slabs, preload)
        alone = run(program, slabs, preload, OTG_PRELOAD_JOIN="off")
        check(abs(many["speed"] - one["speed"]) < 1e-7, "seams are felt", slabs, many, one)
        if slabs >= 8:
            check(one["speed"] - alone["speed"] > 5e-6, "there is nothing to join", slabs, alone)
        print(slabs, many, alone)
    # A slab that is put 0.2 m lower while the ball rolls: it falls as far.
    for slabs in (2, 8):
        moved = run(program, slabs, preload, "moving")
        check(abs(moved["height"] + 0.2) < 1e-3, "the slab is still met where it was", slabs, moved)


main()
