# SPDX-License-Identifier: BSD-3-Clause
"""
Compare with Coal and trimesh on the same poses
===============================================

The same pairs for three libraries: ours, `Coal <https://pypi.org/project/coal/>`_ (which robot planners use), and
`trimesh <https://trimesh.org>`_ with exact booleans.
"""

# %%
# Two tori in 200 random poses. Which of them overlap? All three should agree.

import time

import coal
import matplotlib.pyplot as plt
import numpy as np
import trimesh

import ode_trimesh_gpu as otg

torus = otg.generate.torus(0.5, 0.2, 32, 16)
rng = np.random.default_rng(3)
count = 200
q = rng.normal(size=(count, 4))
poses = np.stack([trimesh.transformations.quaternion_matrix(one / np.linalg.norm(one)) for one in q])
poses[:, :3, 3] = rng.uniform(-0.9, 0.9, (count, 3))

start = time.perf_counter()
ours = otg.collide_many(torus, torus, None, poses)
our_time = time.perf_counter() - start

# %%
# Coal keeps triangle pairs with a depth for each; ours are contacts of the overlap as a whole.

model = coal.BVHModelOBBRSS()
model.beginModel(len(torus.faces), len(torus.vertices))
model.addVertices(torus.vertices.astype(np.float64))
model.addTriangles(torus.faces.astype(np.int64))
model.endModel()
request = coal.CollisionRequest()
request.num_max_contacts = 10000
request.enable_contact = True
still = coal.Transform3s()
coal_overlaps, coal_depths, coal_counts = [], [], []
start = time.perf_counter()
for pose in poses:
    result = coal.CollisionResult()
    coal.collide(model, still, model, coal.Transform3s(pose[:3, :3], pose[:3, 3]), request, result)
    contacts = result.getContacts()
    coal_overlaps.append(result.isCollision())
    coal_depths.append(max((abs(contact.penetration_depth) for contact in contacts), default=0.0))
    coal_counts.append(len(contacts))
coal_time = time.perf_counter() - start

# %%
# The judge: the volume that the two have in common, by a boolean operation.

peer = trimesh.Trimesh(torus.vertices.astype(float), torus.faces, process=False)
volumes = []
start = time.perf_counter()
for pose in poses:
    common = trimesh.boolean.intersection([peer, peer.copy().apply_transform(pose)], engine="manifold")
    volumes.append(common.volume if len(common.faces) else 0.0)
boolean_time = time.perf_counter() - start
volumes = np.array(volumes)

overlap = ours.counts > 0
print(f"overlapping pairs: ours {overlap.sum()}, Coal {np.sum(coal_overlaps)}, booleans {(volumes > 0).sum()}")
print(f"disagreements: Coal {np.sum(overlap != coal_overlaps)}, booleans {np.sum(overlap != (volumes > 0))}")
print(f"seconds: ours {our_time:.3f}, Coal {coal_time:.3f}, booleans {boolean_time:.3f}")
print(f"contacts of an overlapping pair: ours {ours.counts[overlap].mean():.0f}, Coal {np.mean(coal_counts):.0f}")

# %%
# A contact manifold should separate the two. Move the first torus along the deepest contact's normal by its depth: how
# much of the common volume is left? Coal's depths are those of single triangles. Rings that are linked, or lie across
# each other, have no short way out: there our depth is cut (`Contacts.clamped`), and the volume stays.

left = []
for pair in np.flatnonzero(overlap):
    contacts = ours[pair]
    deepest = contacts.depths.argmax()
    away = np.eye(4)
    away[:3, 3] = contacts.normals[deepest] * contacts.depths[deepest]
    common = trimesh.boolean.intersection(
        [peer.copy().apply_transform(away), peer.copy().apply_transform(poses[pair])], engine="manifold"
    )
    left.append((common.volume if len(common.faces) else 0.0) / volumes[pair] if volumes[pair] > 0 else 0.0)

figure, axes = plt.subplots(1, 2, figsize=(10, 4))
axes[0].loglog(volumes[overlap], ours.max_depths[overlap], ".", label="ours")
axes[0].loglog(volumes[overlap], np.array(coal_depths)[overlap], ".", label="Coal")
axes[0].set_xlabel("common volume")
axes[0].set_ylabel("largest penetration depth")
axes[0].legend()
axes[1].hist(left, bins=20)
axes[1].set_xlabel("part of the volume left after the deepest contact's move")
axes[1].set_ylabel("pairs")
figure.tight_layout()
plt.show()
