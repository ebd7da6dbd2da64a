// The page: a scene that is turned with the mouse, a time line, arrows at contacts, and charts.
class Viewer {
  constructor(run) {
    this.run = run;
    this.time = 0;
    this.playing = false;
    this.renderer = new THREE.WebGLRenderer({canvas: this.element("scene"), antialias: true, preserveDrawingBuffer: true});
    this.renderer.autoClear = false;
    this.renderer.gammaOutput = true;
    this.renderer.gammaFactor = 2.2;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    this.scene = new THREE.Scene();
    this.arrowScene = new THREE.Scene();  // drawn last: bodies do not hide it
    this.center = new THREE.Vector3(...run.stage.center);
    this.addCamera();
    this.addLights();
    this.addBodies();
    this.addPlanes();
    this.addArrows();
    this.addCharts();
    this.addControls();
    this.resize();
    this.seek(0);
  }

  element(id) {
    return document.getElementById(id);
  }

  addCamera() {
    const {radius} = this.run.stage;
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.01 * radius, 200 * radius);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, this.element("scene"));
    this.controls.enableKeys = false;
    this.controls.addEventListener("change", () => this.draw());
    this.resetView();
  }

  resetView() {
    const away = new THREE.Vector3(...this.run.view_from).multiplyScalar(2.9 * this.run.stage.radius);
    // A tall window sees less to the sides.
    if (this.camera.aspect < 1) away.divideScalar(Math.max(0.5, this.camera.aspect));
    this.camera.position.copy(this.center).add(away);
    this.controls.target.copy(this.center);
    this.controls.update();
  }

  addLights() {
    const {radius} = this.run.stage;
    for (const scene of [this.scene, this.arrowScene]) {
      scene.add(new THREE.HemisphereLight(0xdfe8f5, 0x8a8378, 0.75));
      const sun = new THREE.DirectionalLight(0xfff4e2, 0.7);
      sun.position.copy(this.center).add(new THREE.Vector3(-0.5, -0.4, 0.9).multiplyScalar(4 * radius));
      sun.target.position.copy(this.center);
      scene.add(sun, sun.target);
      if (scene === this.arrowScene) continue;
      sun.castShadow = true;
      sun.shadow.mapSize.set(2048, 2048);
      sun.shadow.bias = -0.0005;
      Object.assign(sun.shadow.camera, {
        left: -1.6 * radius, right: 1.6 * radius, top: 1.6 * radius, bottom: -1.6 * radius, near: 0.1 * radius, far: 10 * radius,
      });
    }
  }

  addBodies() {
    const geometries = this.run.surfaces.map((surface) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(surface.positions, 3));
      geometry.setAttribute("normal", new THREE.BufferAttribute(surface.normals, 3, true));
      geometry.setIndex(new THREE.BufferAttribute(surface.indices, 1));
      return geometry;
    });
    this.meshes = this.run.bodies.map((body) => {
      const material = new THREE.MeshStandardMaterial({roughness: 0.7, metalness: 0, side: THREE.DoubleSide});
      material.color.setRGB(...body.color);
      const mesh = new THREE.Mesh(geometries[body.surface], material);
      mesh.name = body.name;
      mesh.castShadow = body.poses > 1;
      mesh.receiveShadow = true;
      this.scene.add(mesh);
      return mesh;
    });
  }

  addPlanes() {
    const size = 12 * this.run.stage.radius;
    for (const plane of this.run.planes) {
      const normal = new THREE.Vector3(...plane.normal), length = normal.length();
      normal.divideScalar(length);
      const material = new THREE.MeshStandardMaterial({roughness: 1, metalness: 0, color: 0x8d949e});
      const mesh = new THREE.Mesh(new THREE.PlaneBufferGeometry(size, size), material);
      mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
      // The place of the plane that is nearest to the stage.
      mesh.position.copy(this.center).addScaledVector(normal, plane.offset / length - normal.dot(this.center));
      mesh.receiveShadow = true;
      this.scene.add(mesh);
    }
  }

  addArrows() {
    const {colors, usual_depth: usual} = this.run.contacts, length = 0.2 * this.run.stage.radius;
    this.arrowLength = length;
    const outline = [[0, 0], [0.035, 0], [0.035, 0.68], [0.09, 0.68], [0, 1]];
    const shape = new THREE.LatheBufferGeometry(outline.map(([x, y]) => new THREE.Vector2(x, y)), 12);
    const most = colors.map((_, color) => Math.max(1, ...this.run.contactFrames.map(
        (frame) => frame.depths.reduce((sum, depth) => sum + (this.colorOf(depth) === color), 0))));
    this.arrows = colors.map((color, i) => {
      const material = new THREE.MeshLambertMaterial({side: THREE.DoubleSide});
      material.color.setRGB(...color);
      // A geometry of its own: three.js r111 keeps the instances of the one before otherwise.
      const mesh = new THREE.InstancedMesh(shape.clone(), material, most[i]);
      mesh.frustumCulled = false;
      mesh.count = 0;
      this.arrowScene.add(mesh);
      const swatch = document.createElement("b");
      swatch.style.background = material.color.clone().convertLinearToSRGB().getStyle();
      document.querySelector("#legend i").append(swatch);
      return mesh;
    });
    const legend = this.element("legend");
    legend.hidden = this.run.contacts.count === 0;
    this.element("deepest").textContent = `${Viewer.lengthText(usual)} penetration depth`;
  }

  colorOf(depth) {
    const {colors, usual_depth: usual} = this.run.contacts;
    return usual > 0 ? Math.min(colors.length - 1, Math.floor(depth / usual * colors.length)) : 0;
  }

  static lengthText(metres) {
    const [unit, name] = metres >= 1 ? [1, "m"] : metres >= 1e-3 ? [1e-3, "mm"] : [1e-6, "µm"];
    return `${Number((metres / unit).toPrecision(2))} ${name}`;
  }

  addCharts() {
    const {series, dt, duration} = this.run, seek = (time) => this.seek(time);
    this.charts = [
      new Chart(this.element("contacts"), [{values: series.contacts, color: "--high"}], dt, duration, seek),
      new Chart(this.element("energy"), [
        {values: series.total, color: "--ink", label: "total"},
        {values: series.potential, color: "--green", label: "potential"},
        {values: series.kinetic, color: "--blue", label: "kinetic"},
      ], dt, duration, seek),
    ];
  }

  addControls() {
    const {run} = this;
    document.querySelector("h1").textContent = run.title;
    const triangles = run.bodies.reduce((sum, body) => sum + run.surfaces[body.surface].indices.length / 3, 0);
    this.element("summary").textContent =
        `${run.bodies.length} bodies, ${triangles.toLocaleString("en")} triangles, ${run.steps.count} steps of ${run.dt * 1000} ms`;
    const on = (id, event, act) => this.element(id).addEventListener(event, act);
    this.element("time").max = run.duration;
    on("time", "input", () => this.seek(Number(this.element("time").value)));
    on("play", "click", () => this.play(!this.playing));
    on("view", "click", () => this.resetView());
    on("arrows", "change", () => this.draw());
    on("glass", "change", () => this.setGlass());
    window.addEventListener("resize", () => this.resize());
    document.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.tagName === "SELECT") return;
    const toggle = (id) => this.element(id).click();
    const speed = (by) => {
      const choice = this.element("speed");
      choice.selectedIndex = Math.max(0, Math.min(choice.length - 1, choice.selectedIndex + by));
    };
    const acts = {
      " ": () => this.play(!this.playing),
      ArrowLeft: () => this.seek(this.time - this.run.frameTime),
      ArrowRight: () => this.seek(this.time + this.run.frameTime),
      Home: () => this.seek(0), End: () => this.seek(this.run.duration),
      "[": () => speed(-1), "]": () => speed(1),
      c: () => toggle("arrows"), x: () => toggle("glass"), r: () => this.resetView(),
    };
    if (!acts[event.key]) return;
    acts[event.key]();
    event.preventDefault();
  }

  setGlass() {
    const glass = this.element("glass").checked;
    for (const mesh of this.meshes.filter((_, i) => this.run.bodies[i].poses > 1)) {
      Object.assign(mesh.material, {transparent: glass, opacity: glass ? 0.35 : 1, depthWrite: !glass, needsUpdate: true});
    }
    this.draw();
  }

  play(on) {
    if (on && this.time >= this.run.duration) this.time = 0;
    this.playing = on && this.run.duration > 0;
    const button = this.element("play");
    button.classList.toggle("playing", this.playing);
    button.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    let before = null;
    const tick = (now) => {
      if (!this.playing) return;
      const passed = before === null ? 0 : (now - before) / 1000 * Number(this.element("speed").value);
      before = now;
      this.show(this.time + passed);
      if (this.time >= this.run.duration) this.play(false);
      else requestAnimationFrame(tick);
    };
    if (this.playing) requestAnimationFrame(tick);
  }

  // Chooses a time, in seconds, and stops there.
  seek(time) {
    if (this.playing) this.play(false);
    this.show(time);
  }

  show(time) {
    this.time = Math.max(0, Math.min(this.run.duration, time || 0));
    this.placeBodies();
    this.placeArrows();
    this.element("time").value = this.time;
    this.element("clock").textContent = `${this.time.toFixed(2)} of ${this.run.duration.toFixed(2)} s`;
    for (const chart of this.charts) {
      chart.now = this.time;
      chart.draw();
    }
    const step = this.charts[0].step, {series} = this.run;
    this.element("contacts_now").textContent = step < 0 ? "" : series.contacts[step];
    this.element("energy_now").textContent = step < 0 ? "" : `total ${series.total[step].toPrecision(5)}`;
    this.draw();
  }

  get frame() {
    return Math.min(this.run.frames - 1, Math.floor(this.time / (this.run.frameTime || 1) + 1e-6));
  }

  // Between frames bodies go straight and turn evenly.
  placeBodies() {
    const frame = this.frame, share = this.time / (this.run.frameTime || 1) - frame;
    const p = new THREE.Vector3(), q = new THREE.Quaternion();
    this.run.bodies.forEach((body, i) => {
      const read = (at) => {
        const r = body.rotations;
        p.fromArray(body.positions, 3 * at);
        q.set(r[4 * at + 1], r[4 * at + 2], r[4 * at + 3], r[4 * at]).normalize();
      };
      const mesh = this.meshes[i], last = body.poses - 1;
      read(Math.min(frame, last));
      mesh.position.copy(p);
      mesh.quaternion.copy(q);
      if (share > 1e-6 && frame < last) {
        read(frame + 1);
        mesh.position.lerp(p, share);
        mesh.quaternion.slerp(q, share);
      }
    });
  }

  placeArrows() {
    const frame = this.run.contactFrames[this.frame];
    const up = new THREE.Vector3(0, 1, 0), direction = new THREE.Vector3(), place = new THREE.Vector3();
    const turn = new THREE.Quaternion(), matrix = new THREE.Matrix4();
    const size = new THREE.Vector3(1, 1, 1).multiplyScalar(this.arrowLength);
    for (const mesh of this.arrows) mesh.count = 0;
    for (let i = 0; i < frame.count; ++i) {
      direction.fromArray(frame.directions, 3 * i).normalize();
      turn.setFromUnitVectors(up, direction);
      matrix.compose(place.fromArray(frame.positions, 3 * i), turn, size);
      const mesh = this.arrows[this.colorOf(frame.depths[i])];
      mesh.setMatrixAt(mesh.count++, matrix);
    }
    for (const mesh of this.arrows) mesh.instanceMatrix.needsUpdate = true;
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.element("stage");
    this.renderer.setPixelRatio(window.devicePixelRatio || 1);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
    if (!this.sized) this.resetView();
    this.sized = true;
    for (const chart of this.charts) chart.draw();
    this.draw();
  }

  draw() {
    if (!this.sized) return;
    const paper = getComputedStyle(document.documentElement).getPropertyValue("--paper").trim();
    this.renderer.setClearColor(new THREE.Color(paper).convertSRGBToLinear());
    this.renderer.clear();
    this.renderer.render(this.scene, this.camera);
    if (!this.element("arrows").checked) return;
    this.renderer.clearDepth();
    this.renderer.render(this.arrowScene, this.camera);
  }
}

// PAGE.html#t=1.5 shows that time and waits; #glass sees through bodies.
(() => {
  const wanted = new URLSearchParams(location.hash.slice(1));
  try {
    const viewer = new Viewer(readRun(document.getElementById("run").textContent));
    window.viewer = viewer;
    if (wanted.has("glass")) document.getElementById("glass").click();
    if (wanted.has("t")) viewer.seek(Number(wanted.get("t")));
    else viewer.play(true);
    document.body.dataset.state = "ready";
  } catch (error) {
    const trouble = document.getElementById("trouble");
    trouble.hidden = false;
    trouble.textContent = `The run cannot be shown: ${error.message}`;
    document.body.dataset.state = "failed";
    throw error;
  }
})();
