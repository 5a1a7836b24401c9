// The scene in the target's frame: target, Sun, trail, and the camera where it was and was thought.

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
  const axis = sine > 0 ? new Vector3(turn.x, turn.y, turn.z).divideScalar(sine)
    : new Vector3(1, 0, 0);
  const rotation = new three.Quaternion().setFromAxisAngle(axis, Math.min(times * angle, Math.PI))
    .multiply(was.rotation);
  const place = said.place.clone().sub(was.place).multiplyScalar(times).add(was.place);
  return { rotation, place };
}

const anyPoses = () => Object.values(data.pipelines).map((each) => each.poses);
const hasScene = () =>
  Boolean(data.scene) && [data.scene.true, ...anyPoses()].some((x) => x.some(Boolean));

function startScene() {
  if (!hasScene()) return;
  const own = data.scene;
  const trueCameras = own.true.map((pose) => pose && cameraOf(pose));
  const trailPoints = trueCameras.filter(Boolean).map((each) => each.place);
  const first = trailPoints[0] ?? cameraOf(anyPoses().flat().find(Boolean)).place;
  // Up is the axis most across the camera's way.
  const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(vector), ahead = first.clone().normalize();
  const up = axes.reduce((best, axis) =>
    Math.abs(axis.dot(ahead)) < Math.abs(best.dot(ahead)) ? axis : best);
  const titles = { target: "target" };
  if (own.markers.length) titles.markers = "markers";
  if (Object.keys(own.clouds).length) titles.cloud = "points found";
  if (trailPoints.length) titles.trail = "trail";
  Object.assign(titles, { estimated: "estimated camera", true: "true camera", Sun: "Sun" });
  const stage = makeStage(byId("scene"), titles, up, () => follows());
  if (!stage) return;
  const { parts, light } = stage;
  light.position.copy(ahead);

  if (trailPoints.length) {
    parts.trail.add(lines(trailPoints, "#7f93a3", true), dots(trailPoints, "#7f93a3", 3));
  }
  if (own.markers.length) parts.markers.add(dots(own.markers.map(vector), "#ff4d40", 4));
  if (own.edges.length) parts.target.add(lines(own.edges.flat().map(vector), "#8fa3b3"));
  const everyPoint = [...own.markers, ...own.edges.flat(), ...Object.values(own.clouds).flat()];
  let radius = Math.max(1, ...everyPoint.map((point) => Math.hypot(...point)));
  if (own.glb) {
    const bytes = Uint8Array.from(atob(own.glb), (sign) => sign.charCodeAt(0));
    new three.GLTFLoader().parse(bytes.buffer, "", (loaded) => {
      loaded.scene.traverse((each) => {
        if (!each.isMesh) return;
        each.material = new three.MeshLambertMaterial({ color: each.material.color, flatShading: true,
          side: 2, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
        const { array } = each.geometry.getAttribute("position");
        for (let k = 0; k < array.length; k += 3) {
          radius = Math.max(radius, Math.hypot(array[k], array[k + 1], array[k + 2]));
        }
      });
      parts.target.add(loaded.scene);
      stage.canvas.dataset.target = "loaded";
      follows();
      wholeTarget();
    }, (fault) => console.error("the scene's target", fault));
  }

  // What a camera at the origin sees, a metre deep.
  function frustum() {
    const corners = own.corner_rays_in_cam.map((ray) => vector(ray).divideScalar(ray[2]));
    const points = [], place = new Vector3();
    corners.forEach((corner, k) => points.push(place, corner, corner, corners[(k + 1) % 4]));
    const top = corners[0].clone().add(corners[1]).multiplyScalar(0.5); // the image's upper edge
    points.push(top, top.clone().multiplyScalar(0.75));
    return lines(points, "#ffffff");
  }
  const frusta = { true: frustum(), estimated: frustum() };
  const arrow = new three.ArrowHelper(ahead, new Vector3(), 1, "#d9a916");

  function setCamera(name, { rotation, place }, reach, colour) {
    const drawn = frusta[name];
    drawn.position.copy(place);
    drawn.quaternion.copy(rotation);
    drawn.scale.setScalar(reach);
    drawn.material = material("LineBasicMaterial", { color: colour });
    parts[name].add(drawn);
  }

  const aside = new Vector3().crossVectors(up, ahead).normalize();
  const from = ahead.clone().addScaledVector(aside, 1.2).addScaledVector(up, 0.6);

  function wholeTarget() {
    stage.lookAt(new Vector3(), radius, from);
  }

  // The camera's way, and what it faces: the markers, or the middle of the target.
  function trail() {
    const faced = own.markers.length ? own.markers.map(vector) : [new Vector3()];
    const points = [...trailPoints, ...faced];
    const middle = points.reduce((sum, x) => sum.add(x), new Vector3()).divideScalar(points.length);
    const reach = Math.max(0.5, ...points.map((point) => point.distanceTo(middle)));
    stage.lookAt(middle, 1.1 * reach, from);
  }

  let times = 1, cloudOf = null;
  function follows() {
    const was = trueCameras[shown.place];
    const pose = posesNow()[shown.place];
    for (const name of ["true", "estimated", "Sun"]) parts[name].clear();
    const reach = 0.4 * (was?.place.length() ?? (pose ? cameraOf(pose).place.length() : 1));
    if (was) setCamera("true", was, reach, colourOf("--truth"));
    if (pose) {
      const said = cameraOf(pose);
      setCamera("estimated", was ? exaggerated(said, was, times) : said, reach,
        colourOf("--said"));
    }
    if (parts.cloud && cloudOf !== shown.pipeline) {
      cloudOf = shown.pipeline;
      const points = own.clouds[cloudOf] ?? [];
      emptied(parts.cloud);
      if (points.length) parts.cloud.add(dots(points.map(vector), "#f0a04b", 3));
    }
    const sun = own.sun_in_target[shown.place];
    if (sun) {
      arrow.setDirection(vector(sun));
      arrow.setLength(0.9 * radius, 0.08 * radius, 0.05 * radius);
      parts.Sun.add(arrow);
      light.position.copy(vector(sun));
    }
    stage.tell({ poses: [was && "true", pose && "estimated"].filter(Boolean).join(" ") });
  }

  stage.bar.append(choice("difference", [1, 10, 100, 1000, 10000].map((x) => [x, `× ${x}`]),
    (value) => { times = Number(value); follows(); }));
  stage.bar.append(button("whole target", wholeTarget));
  if (trailPoints.length) stage.bar.append(button("camera's way", trail));
  stage.bar.append(button("closer", () => stage.closer(0.8)),
    button("farther", () => stage.closer(1.25)));
  byId("scene").querySelector(".note").textContent =
    `In the target's frame. ${trailPoints.length ? "Cyan: the camera as it was; " : ""}green: as `
    + "estimated, its difference from the truth enlarged by the factor chosen. Yellow: towards the "
    + `Sun.${trailPoints.length ? " Grey: the camera's way." : ""}`
    + `${parts.cloud ? " Orange: the points of the target that the pipeline ends with." : ""}`
    + `${own.glb ? " The target is shown in few triangles." : ""}`;
  follow(follows);
  wholeTarget();
}
