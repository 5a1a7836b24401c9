// The scene in the target's frame: target, Sun, trail, and the camera where it was and was thought.

function startScene() {
  const own = data.scene;
  const poses = (label) => data.pipelines[label].poses;
  if (!own || ![own.true, ...Object.keys(data.pipelines).map(poses)].some((x) => x.some(Boolean))) {
    return;
  }
  const home = byId("scene");
  const canvas = home.querySelector("canvas");
  home.hidden = false;
  let renderer;
  try {
    renderer = new three.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  } catch {
    home.replaceChildren(made("p", { className: "note",
      textContent: "The scene needs WebGL, which this browser does not give." }));
    return;
  }
  const scene = new three.Scene();
  const eye = new three.PerspectiveCamera(45, 1, 0.01, 1e6);
  const parts = { target: new three.Group(), markers: new three.Group(), trail: new three.Group(),
    estimated: new three.Group(), true: new three.Group(), Sun: new three.Group() };
  scene.add(...Object.values(parts));
  const light = new three.DirectionalLight(0xffffff, 2.6);
  scene.add(light, new three.AmbientLight(0xffffff, 0.7));

  const lines = (points, colour, joined = false) => {
    const shape = new three.BufferGeometry().setFromPoints(points);
    const material = new three.LineBasicMaterial({ color: colour });
    return joined ? new three.Line(shape, material) : new three.LineSegments(shape, material);
  };
  const dots = (points, colour, size) => new three.Points(
    new three.BufferGeometry().setFromPoints(points),
    new three.PointsMaterial({ color: colour, size, sizeAttenuation: false }));
  const vector = (x) => new three.Vector3(...x);

  // Camera in the target's frame, of nine numbers of a rotation and three of a translation.
  function cameraOf(pose) {
    const turn = new three.Matrix4().set(pose[0], pose[1], pose[2], 0, pose[3], pose[4], pose[5], 0,
      pose[6], pose[7], pose[8], 0, 0, 0, 0, 1).transpose();
    const rotation = new three.Quaternion().setFromRotationMatrix(turn);
    const place = vector(pose.slice(9)).applyQuaternion(rotation).negate();
    return { rotation, place };
  }

  // The estimate, its difference from the truth made so many times larger.
  function exaggerated(said, was, times) {
    const turn = said.rotation.clone().multiply(was.rotation.clone().invert());
    if (turn.w < 0) turn.set(-turn.x, -turn.y, -turn.z, -turn.w);
    const sine = Math.hypot(turn.x, turn.y, turn.z);
    const angle = 2 * Math.atan2(sine, turn.w);
    const axis = sine > 0 ? new three.Vector3(turn.x, turn.y, turn.z).divideScalar(sine)
      : new three.Vector3(1, 0, 0);
    const rotation = new three.Quaternion().setFromAxisAngle(axis, Math.min(times * angle, Math.PI))
      .multiply(was.rotation);
    const place = said.place.clone().sub(was.place).multiplyScalar(times).add(was.place);
    return { rotation, place };
  }

  function frustum({ rotation, place }, reach, colour) {
    const corners = own.corner_rays_in_cam.map((ray) => vector(ray).multiplyScalar(reach / ray[2])
      .applyQuaternion(rotation).add(place));
    const points = [];
    corners.forEach((corner, k) => points.push(place, corner, corner, corners[(k + 1) % 4]));
    const up = corners[0].clone().add(corners[1]).multiplyScalar(0.5); // the image's upper edge
    points.push(up, up.clone().lerp(place, 0.25));
    return lines(points, colour);
  }

  const trueCameras = own.true.map((pose) => pose && cameraOf(pose));
  const trailPoints = trueCameras.filter(Boolean).map((each) => each.place);
  if (trailPoints.length) parts.trail.add(lines(trailPoints, "#7f93a3", true), dots(trailPoints, "#7f93a3", 3));
  if (own.markers.length) parts.markers.add(dots(own.markers.map(vector), "#ff4d40", 4));
  if (own.edges.length) parts.target.add(lines(own.edges.flat().map(vector), "#8fa3b3"));
  let radius = Math.max(1, ...own.markers.flat().map(Math.abs), ...own.edges.flat(2).map(Math.abs));
  if (own.glb) {
    const bytes = Uint8Array.from(atob(own.glb), (sign) => sign.charCodeAt(0));
    new three.GLTFLoader().parse(bytes.buffer, "", (loaded) => {
      loaded.scene.traverse((each) => {
        if (!each.isMesh) return;
        each.material = new three.MeshLambertMaterial({ color: each.material.color, flatShading: true,
          side: 2, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
        each.geometry.computeBoundingSphere();
        const ball = each.geometry.boundingSphere;
        radius = Math.max(radius, ball.center.length() + ball.radius);
      });
      parts.target.add(loaded.scene);
      canvas.dataset.target = "loaded";
      follows();
      frameAll(["target", "trail"]);
    }, (fault) => console.error("the scene's target", fault));
  }

  // Up is the axis most across the camera's way; the controls keep what is up when they are made.
  const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(vector);
  const ahead = trailPoints[0]?.clone().normalize() ?? axes[2];
  eye.up.copy(axes.reduce((best, axis) =>
    Math.abs(axis.dot(ahead)) < Math.abs(best.dot(ahead)) ? axis : best));
  light.position.copy(ahead);
  const controls = new three.OrbitControls(eye, canvas);
  canvas.style.touchAction = "pan-y"; // up and down the page scrolls, sideways the scene turns
  controls.enableZoom = false; // the page scrolls; see the wheel below
  controls.addEventListener("change", render);
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== canvas) return;
    event.preventDefault();
    closer(Math.exp(0.002 * event.deltaY));
  }, { passive: false });

  function closer(factor) {
    eye.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
    controls.update();
    render();
  }

  function turn(about, tilt) {
    const from = eye.position.clone().sub(controls.target);
    const side = new three.Vector3().crossVectors(eye.up, from).normalize();
    from.applyQuaternion(new three.Quaternion().setFromAxisAngle(eye.up, about));
    const tilted = from.clone().applyQuaternion(new three.Quaternion().setFromAxisAngle(side, tilt));
    if (Math.abs(tilted.clone().normalize().dot(eye.up)) < 0.98) from.copy(tilted);
    eye.position.copy(from).add(controls.target);
    controls.update();
    render();
  }
  const keys = {
    ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, -0.1),
    ArrowDown: () => turn(0, 0.1), "+": () => closer(0.8), "=": () => closer(0.8),
    "-": () => closer(1.25),
  };
  canvas.addEventListener("keydown", (event) => {
    if (!(event.key in keys) || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
  });

  // Look at the whole target, or at the camera's trail with what it faces.
  function frameAll(what) {
    const points = what.includes("trail") ? [...trailPoints, ...own.markers.map(vector)] : [];
    const reach = Math.max(what.includes("target") ? radius : 0.5,
      ...points.map((point) => point.length()));
    const first = trailPoints[0]?.clone().normalize() ?? new three.Vector3(0, 0, 1);
    const aside = new three.Vector3().crossVectors(eye.up, first).normalize();
    const from = first.add(aside.multiplyScalar(1.2)).addScaledVector(eye.up, 0.6).normalize();
    controls.target.set(0, 0, 0);
    eye.position.copy(from.multiplyScalar(1.9 * reach));
    eye.near = 0.002 * reach;
    eye.far = 50 * reach;
    eye.updateProjectionMatrix();
    controls.update();
    render();
  }

  function render() {
    scene.background = new three.Color(colourOf("--scene"));
    renderer.render(scene, eye);
    canvas.dataset.eye = eye.position.toArray().map((x) => x.toFixed(4)).join(" ");
  }

  function emptied(group) {
    group.children.forEach((each) => { each.geometry?.dispose(); each.material?.dispose(); });
    group.clear();
    return group;
  }

  let times = 1;
  function follows() {
    const was = trueCameras[shown.place];
    const pose = poses(shown.pipeline)[shown.place];
    emptied(parts.true);
    emptied(parts.estimated);
    emptied(parts.Sun);
    const reach = 0.4 * (was?.place.length() ?? (pose ? cameraOf(pose).place.length() : 1));
    if (was) parts.true.add(frustum(was, reach, "#46d6ff"));
    if (pose) {
      const said = cameraOf(pose);
      parts.estimated.add(frustum(was ? exaggerated(said, was, times) : said, reach, "#4ade60"));
    }
    const sun = own.sun_in_target[shown.place];
    if (sun) {
      parts.Sun.add(new three.ArrowHelper(vector(sun), new three.Vector3(), 0.7 * radius, "#f5c542",
        0.08 * radius, 0.05 * radius));
      light.position.copy(vector(sun));
    }
    canvas.dataset.frame = data.frames[shown.place].frame;
    canvas.dataset.poses = [was && "true", pose && "estimated"].filter(Boolean).join(" ");
    canvas.setAttribute("aria-label", `the scene at ${data.frames[shown.place].title}: `
      + Object.keys(parts).filter((name) => parts[name].visible && parts[name].children.length).join(", "));
    render();
  }

  const bar = home.querySelector(".choices");
  bar.append(...Object.keys(parts).map((name) => toggle(
    { true: "true camera", estimated: "estimated camera" }[name] ?? name, true,
    (on) => { parts[name].visible = on; follows(); })));
  bar.append(choice("difference", [1, 10, 100, 1000].map((x) => [x, `× ${x}`]),
    (value) => { times = Number(value); follows(); }));
  bar.append(button("whole target", () => frameAll(["target", "trail"])),
    button("trail", () => frameAll(["trail"])),
    button("closer", () => closer(0.8)), button("farther", () => closer(1.25)));
  follow(follows);
  new ResizeObserver(() => {
    const wide = home.clientWidth;
    const high = Math.min(0.8 * wide, 0.8 * globalThis.innerHeight);
    renderer.setPixelRatio(Math.min(2, globalThis.devicePixelRatio || 1));
    renderer.setSize(wide, high);
    eye.aspect = wide / high;
    eye.updateProjectionMatrix();
    render();
  }).observe(home);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", render);
  frameAll(["target", "trail"]);
}
