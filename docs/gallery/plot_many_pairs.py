# SPDX-License-Identifier: BSD-3-Clause
"""
Many pairs on a GPU
===================

Batches of one to several thousand pairs, on one thread, on all threads, and on an OpenCL device where one is found. The
contacts are the same, to the last bit.
"""

# %%
# A device has to be opened once; that takes some tens of seconds the first time on a machine. PoCL, which makes the CPU
# a device, counts as one, but is no faster than the threads. Here it is left out.

import time

import matplotlib.pyplot as plt
import numpy as np

import ode_trimesh_gpu as otg

has_gpu = otg.set_backend("auto")
print(otg.devices() or "no GPU: the CPU computes")

# %%
# A lump in random places around another one.

lump = otg.generate.lump(0.5, level=3, amplitude=0.3, seed=2)
rng = np.random.default_rng(0)
sizes = [1, 4, 16, 64, 256, 1024, 4096]
poses = np.tile(np.eye(4), (sizes[-1], 1, 1))
poses[:, :3, 3] = rng.normal(size=(sizes[-1], 3)) * 0.5


def best_time(size, options):
    times = []
    for _ in range(3):
        start = time.perf_counter()
        batch = otg.collide_many(lump, lump, poses[:size], options=options)
        times.append(time.perf_counter() - start)
    return min(times), batch.contacts.positions.tobytes()


ways = {"one thread": (1, "cpu"), f"{otg.get_threads()} threads": (0, "cpu")}
if has_gpu:
    ways["GPU"] = (0, "opencl")
results, contents = {}, {}
for name, (threads, backend) in ways.items():
    otg.set_threads(threads)
    results[name] = []
    for size in sizes:
        seconds, content = best_time(size, otg.Options(backend=backend))
        results[name].append(seconds / size * 1e6)
        assert contents.setdefault(size, content) == content
otg.set_threads(0)

# %%

for name, values in results.items():
    plt.loglog(sizes, values, "o-", label=name)
plt.xlabel("pairs in a batch")
plt.ylabel("microseconds for each pair")
plt.legend()
plt.title("The same bytes in each way")
plt.tight_layout()
plt.show()
