// The recording in the page: base64 of little-endian numbers, written by harness/scenes/html_page.cpp.
"use strict";

const readRun = (() => {
  function bytes(text) {
    const binary = atob(text), result = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; ++i) result[i] = binary.charCodeAt(i);
    return result.buffer;
  }

  // Points on a grid: a corner, and multiples of a step.
  function points(steps, low, step) {
    const result = new Float32Array(steps.length);
    for (let i = 0; i < steps.length; ++i) result[i] = low[i % 3] + steps[i] * step;
    return result;
  }

  function surface(packed) {
    return {
      positions: points(new Uint16Array(bytes(packed.positions)), packed.low, packed.step),
      normals: new Int8Array(bytes(packed.normals)),  // of 127
      indices: new (packed.index_bits === 16 ? Uint16Array : Uint32Array)(bytes(packed.indices)),
    };
  }

  function body(packed) {
    return {
      name: packed.name, surface: packed.surface, color: packed.color, poses: packed.poses,
      positions: new Float32Array(bytes(packed.positions)),
      rotations: new Int16Array(bytes(packed.rotations)),  // w, x, y, z of 32767
    };
  }

  // Frame by frame: positions in the world, unit directions, depths in metres.
  function contacts(packed, frames) {
    const starts = new Uint32Array(bytes(packed.starts)), low = new Float32Array(bytes(packed.low));
    const step = new Float32Array(bytes(packed.step)), places = new Uint16Array(bytes(packed.positions));
    const directions = new Int8Array(bytes(packed.directions)), depths = new Uint16Array(bytes(packed.depths));
    const result = [];
    for (let f = 0; f < frames; ++f) {
      const from = starts[f], to = starts[f + 1];
      result.push({
        count: to - from,
        positions: points(places.subarray(3 * from, 3 * to), low.subarray(3 * f, 3 * f + 3), step[f]),
        directions: directions.subarray(3 * from, 3 * to),
        depths: Float32Array.from(depths.subarray(from, to), (d) => d * packed.depth_step),
      });
    }
    return result;
  }

  return function readRun(text) {
    const run = JSON.parse(text);
    run.surfaces = run.surfaces.map(surface);
    run.bodies = run.bodies.map(body);
    run.contactFrames = contacts(run.contacts, run.frames);
    run.frameTime = run.dt * run.steps_per_frame;
    run.duration = run.frameTime * (run.frames - 1);
    const kinetic = new Float32Array(bytes(run.steps.kinetic)), potential = new Float32Array(bytes(run.steps.potential));
    run.series = {
      contacts: new Uint32Array(bytes(run.steps.contacts)), kinetic, potential,
      total: Float32Array.from(kinetic, (k, i) => k + potential[i]),
    };
    return run;
  };
})();

