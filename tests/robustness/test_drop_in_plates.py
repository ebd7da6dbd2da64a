# SPDX-License-Identifier: BSD-3-Clause
"""Flat dTriMeshes on a flat one, in a program that knows nothing of this library.

python3 test_drop_in_plates.py PRELOAD_LIBRARY PROGRAM"""
import json
import os
import subprocess
import sys


def run(program, seed, where, preload=None):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("OTG_PRELOAD")}
    if preload:
        environment["LD_PRELOAD"] = preload
    result = subprocess.run([program, str(seed), where], env=environment, capture_output=True, text=True, timeout=300)
    if result.returncode != 0:
        sys.exit("FAILED: %s" % result.stderr)
    return json.loads(result.stdout)


def main():
    preload, program = sys.argv[1:]
    stock = 0
    for where in ("space", "subspace"):
        for seed in (1, 2, 3):
            stock += run(program, seed, where)["lying"]
            ours = run(program, seed, where, preload)
            if ours["lying"] != ours["of"]:
                sys.exit("FAILED: plates fell through: %s" % ours)
    if stock > 60:
        sys.exit("FAILED: ODE holds them by itself, %d of 72: this tests nothing" % stock)
    print("stock: %d of 72" % stock)


main()
