// A canvas with a scene in it: lit, framed, and turned by mouse, touch and keys.

const { Vector3 } = three;
const COARSE = 0.5, REST_MS = 400;
const vector = (x) => new Vector3(...x);

// Materials are kept: with the last of a kind goes its program, and the next is compiled anew.
const materials = new Map();
function material(kind, settings) {
  const key = kind + JSON.stringify(settings);
  if (!materials.has(key)) materials.set(key, new three[kind](settings));
  return materials.get(key);
}

function lines(points, colour, joined = false) {
  const shape = new three.BufferGeometry().setFromPoints(points);
  const stroke = material("LineBasicMaterial", { color: colour });
  return joined ? new three.Line(shape, stroke) : new three.LineSegments(shape, stroke);
}

function dots(points, colour, size) {
  return new three.Points(new three.BufferGeometry().setFromPoints(points),
    material("PointsMaterial", { color: colour, size, sizeAttenuation: false }));
}

// Whether the browser draws scenes by its processor: asked of a canvas that is thrown away, since
// it decides how the scene's own is made.
let drawnByProcessor = null;
function isSlow() {
  if (drawnByProcessor === null) {
    const context = made("canvas").getContext("webgl2");
    const told = context?.getExtension("WEBGL_debug_renderer_info");
    const name = told ? context.getParameter(told.UNMASKED_RENDERER_WEBGL) : "";
    drawnByProcessor = /swiftshader|llvmpipe|software|basic render/i.test(name);
    context?.getExtension("WEBGL_lose_context")?.loseContext();
  }
  return drawnByProcessor;
}

function emptied(group) {
  group.traverse((each) => each.geometry?.dispose());
  group.clear();
  return group;
}

// Null where the browser has no WebGL. `titles` name the parts, in the order of their switches.
function makeStage(home, titles, up, followed) {
  const canvas = home.querySelector("canvas");
  home.hidden = false;
  const slow = isSlow();
  let renderer;
  try {
    renderer = new three.WebGLRenderer({ canvas, antialias: !slow, preserveDrawingBuffer: true });
  } catch {
    home.replaceChildren(made("p", { className: "note",
      textContent: "The scene needs WebGL, which this browser does not give." }));
    return null;
  }
  const scene = new three.Scene(), ground = new three.Color();
  scene.background = ground;
  const eye = new three.PerspectiveCamera(40, 1, 0.01, 1e6);
  eye.up.copy(up); // the controls keep what is up when they are made
  const parts = Object.fromEntries(Object.keys(titles).map((name) => [name, new three.Group()]));
  scene.add(...Object.values(parts));
  const light = new three.DirectionalLight(0xffffff, 2.6);
  scene.add(light, new three.AmbientLight(0xffffff, 0.8));

  // Without a graphics card what moves is drawn coarse, and once it rests twice as fine as the
  // screen, in place of smoothed edges.
  const own = Math.min(2, globalThis.devicePixelRatio || 1);
  const fine = slow ? 2 : own, coarse = slow ? COARSE * own : own;
  let asked = false, resting = null, near = false;
  function picture(ratio) {
    if (renderer.getPixelRatio() !== ratio) renderer.setPixelRatio(ratio);
    ground.set(colourOf("--scene"));
    renderer.render(scene, eye);
    canvas.dataset.frame = canvas.dataset.next ?? "";
    canvas.dataset.fine = ratio === fine ? "yes" : "";
  }
  function render() {
    canvas.dataset.eye = eye.position.toArray().map((x) => x.toFixed(4)).join(" ");
    canvas.dataset.fine = "";
    if (asked) return;
    asked = true; // one picture for each that the screen shows; out of sight, when there is time
    (near ? requestAnimationFrame : later)(draw);
  }
  function draw() {
    if (!asked) return;
    asked = false;
    picture(coarse);
    clearTimeout(resting);
    if (slow) resting = setTimeout(() => picture(fine), REST_MS);
  }
  new IntersectionObserver((entries) => {
    near = entries.at(-1).isIntersecting;
    if (near) draw();
  }, { rootMargin: "200px" }).observe(canvas);

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
    const side = new Vector3().crossVectors(eye.up, from).normalize();
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

  // Look from a direction at all of a ball.
  function lookAt(middle, reach, from) {
    const fits = reach / Math.sin(0.5 * eye.fov * Math.PI / 180 * Math.min(1, eye.aspect));
    controls.target.copy(middle);
    eye.position.copy(from).normalize().multiplyScalar(fits).add(middle);
    eye.near = 0.002 * reach;
    eye.far = 60 * reach;
    eye.updateProjectionMatrix();
    controls.update();
    render();
  }

  // What is to be seen, for those who do not see it and for tests; then the picture itself.
  function tell(facts) {
    Object.assign(canvas.dataset, facts, { next: data.frames[shown.place].frame });
    const seen = Object.keys(parts).filter((name) => parts[name].visible && parts[name].children.length);
    canvas.dataset.parts = seen.join(" ");
    canvas.setAttribute("aria-label", `The ${home.id.replace("explorer-", "")} at ${data.frames[shown.place].title}: `
      + seen.map((name) => titles[name]).join(", "));
    render();
  }

  const bar = home.querySelector(".choices");
  for (const name of Object.keys(titles)) {
    bar.append(toggle(titles[name], true, (on) => { parts[name].visible = on; followed(); }));
  }
  new ResizeObserver(() => {
    const wide = home.clientWidth, high = Math.min(0.8 * wide, 0.8 * globalThis.innerHeight);
    renderer.setSize(wide, high);
    eye.aspect = wide / high;
    eye.updateProjectionMatrix();
    render();
  }).observe(home);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", followed);
  return { canvas, parts, light, bar, render, closer, lookAt, tell };
}
