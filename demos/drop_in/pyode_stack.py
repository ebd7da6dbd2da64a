#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A program on PyODE (Debian: python3-pyode) that knows nothing of this library: it stacks boxes that are triangle
meshes and says what became of the stack. Run it as it is, and with
LD_PRELOAD=build/lib/libode_trimesh_gpu_preload.so before it.

Arguments: how many boxes, how many steps of 1/240 s."""
import json
import math
import sys
import time

try:
    import ode
except ImportError:
    print("skipped: python3-pyode is not installed", file=sys.stderr)
    sys.exit(77)


def box_mesh(x, y, z):
    vertices = [((x if i & 1 else -x) / 2, (y if i & 2 else -y) / 2, (z if i & 4 else -z) / 2) for i in range(8)]
    faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
             (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
    data = ode.TriMeshData()
    data.build(vertices, faces)
    return data


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    steps = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    world = ode.World()
    world.setGravity((0, 0, -9.81))
    space = ode.HashSpace()
    joints = ode.JointGroup()
    ground_data, box_data = box_mesh(8, 8, 1), box_mesh(1, 1, 1)
    ground = ode.GeomTriMesh(ground_data, space)
    ground.setPosition((0, 0, -0.5))
    bodies, geoms = [], [ground]
    for i in range(count):
        body = ode.Body(world)
        mass = ode.Mass()
        mass.setBox(1000, 1, 1, 1)
        body.setMass(mass)
        body.setPosition((0, 0, 0.5 + i))
        geom = ode.GeomTriMesh(box_data, space)
        geom.setBody(body)
        bodies.append(body)
        geoms.append(geom)

    made = [0]

    def near(_, a, b):
        contacts = ode.collide(a, b)
        made[0] += len(contacts)
        for contact in contacts:
            contact.setMode(ode.ContactApprox1 | ode.ContactSoftERP | ode.ContactSoftCFM)
            contact.setMu(0.7)
            contact.setSoftERP(0.2)
            contact.setSoftCFM(1e-6)
            ode.ContactJoint(world, joints, contact).attach(a.getBody(), b.getBody())

    started = time.perf_counter()
    for _ in range(steps):
        space.collide(None, near)
        world.step(1 / 240)
        joints.empty()
    spent = time.perf_counter() - started

    drift = max(math.hypot(*b.getPosition()[:2]) for b in bodies)
    tilt = max(math.degrees(math.acos(max(-1.0, min(1.0, b.getRotation()[8])))) for b in bodies)
    height = max(abs(b.getPosition()[2] - 0.5 - i) for i, b in enumerate(bodies))
    print(json.dumps({"boxes": count, "steps": steps, "drift_m": drift, "tilt_deg": tilt, "height_error_m": height,
                      "contacts_per_step": made[0] / steps, "ms_per_step": 1e3 * spent / steps}))


main()
