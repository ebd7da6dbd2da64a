# SPDX-License-Identifier: BSD-3-Clause
"""Bodies that are dTriMeshes on a heightfield, in a program that knows nothing of this library.

python3 test_drop_in_hills.py PRELOAD_LIBRARY PROGRAM"""
import json
import os
import subprocess
import sys


def run(program, shape, heights, preload=None, **more):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("OTG_PRELOAD")}
    if preload:
        environment["LD_PRELOAD"] = preload
    environment.update(more)
    result = subprocess.run([program, shape, heights], env=environment, capture_output=True, text=True, timeout=300)
    if result.returncode != 0:
        sys.exit("FAILED: %s" % result.stderr)
    numbers = json.loads(result.stdout)
    for key in ("collide_ms", "heights"):
        del numbers[key]
    return numbers, [line for line in result.stderr.splitlines() if line.strip()]


def check(condition, message, *found):
    if not condition:
        sys.exit("FAILED: %s %s" % (message, found))


def main():
    preload, program = sys.argv[1:]
    box, _ = run(program, "box", "single")
    stock, _ = run(program, "mesh", "single")
    untouched, silent = run(program, "mesh", "single", preload)
    check(untouched == stock, "heightfields are taken over without being asked for", untouched, stock)
    check(not silent, "it prints", silent)
    answers = []
    for heights in ("byte", "short", "single", "double", "callback"):
        ours, lines = run(program, "mesh", heights, preload, OTG_PRELOAD_PRIMITIVES="heightfield",
                          OTG_PRELOAD_VERBOSE="1")
        check(len(lines) == 2 and not lines[-1].split(": ")[1].startswith("0 "), "no pair came through", lines)
        answers.append(ours)
    # Whichever way the program gives its heights, the ground is the same.
    check(all(ours == answers[0] for ours in answers), "kinds of samples differ", answers)
    ours = answers[0]
    check(ours != stock, "nothing changed", ours)
    check(run(program, "mesh", "single", preload, OTG_PRELOAD_PRIMITIVES="all")[0] == ours, "all is not each", ours)
    check(run(program, "box", "single", preload, OTG_PRELOAD_PRIMITIVES="all")[0] == box, "boxes changed", box)
    # Into the valley as ODE's box: 3.5 m in 1.7 s.
    check(abs(ours["way_m"] - box["way_m"]) < 0.005, "it does not slide as a box", ours, box)
    check(ours["aside_m"] < 1e-6 and ours["deepest_m"] < 0.005, "it is not straight, or sinks in", ours)
    check(abs(ours["lowest_m"] - box["lowest_m"]) < 0.002, "it is not as high as a box", ours, box)
    print(box, stock, ours, sep="\n")


main()
