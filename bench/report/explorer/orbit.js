// The scene of an orbit: Earth, the satellite's way, where it was thought, and whom it heard.

const EARTH_M = 6_378_137;
const MEGAMETRE = 1e-6; // what the scene is drawn in: float32 has no room for more

// A ball with a net of parallels and meridians, its axis along z.
function earth() {
  const group = new three.Group(), across = 48, along = 24, points = [], faces = [], net = [];
  const at = (k, m, radius) => {
    const [turn, tilt] = [2 * Math.PI * k / across, Math.PI * (m / along - 0.5)];
    return new Vector3(Math.cos(turn) * Math.cos(tilt), Math.sin(turn) * Math.cos(tilt),
      Math.sin(tilt)).multiplyScalar(radius * EARTH_M * MEGAMETRE);
  };
  for (let m = 0; m <= along; m++) for (let k = 0; k <= across; k++) points.push(at(k, m, 1));
  for (let m = 0; m < along; m++) {
    for (let k = 0; k < across; k++) {
      const a = m * (across + 1) + k, b = a + across + 1;
      faces.push(a, a + 1, b + 1, a, b + 1, b);
      if (k % 4 === 0) net.push(at(k, m, 1.002), at(k, m + 1, 1.002));
      if (m % 4 === 0) net.push(at(k, m, 1.002), at(k + 1, m, 1.002));
    }
  }
  const ball = new three.BufferGeometry().setFromPoints(points);
  ball.setIndex(faces);
  ball.computeVertexNormals();
  group.add(new three.Mesh(ball, new three.MeshLambertMaterial({ color: "#3f6ea3" })),
    lines(net, "#8fb3d9"));
  return group;
}

function startOrbit() {
  const own = data.orbit;
  if (!own) return;
  const scaled = (place) => place && vector(place).multiplyScalar(MEGAMETRE);
  const was = own.true_m.map(scaled);
  const way = was.filter(Boolean);
  const titles = { Earth: "Earth", way: "orbit", true: "true place", estimated: "estimated place",
    senders: "satellites heard" };
  const home = byId(data.scene ? "orbit" : "scene");
  const stage = makeStage(home, titles, new Vector3(0, 0, 1), () => follows());
  if (!stage) return;
  const { parts } = stage;
  const first = way[0] ?? scaled(Object.values(own.said_m).flat().find(Boolean))
    ?? new Vector3(7, 0, 0);
  parts.Earth.add(earth());
  stage.light.position.copy(first).add(new Vector3(0, 0, 0.3 * first.length()));
  if (way.length) parts.way.add(lines(way, "#7f93a3", true));

  const from = first.clone().add(new Vector3(0, 0, 0.5 * first.length()));
  const reach = 1.15 * Math.max(first.length(), EARTH_M * MEGAMETRE);
  const farthest = 1.05 * Math.max(reach, ...own.senders_m.filter(Boolean).flat()
    .map((place) => Math.hypot(...place) * MEGAMETRE));

  // Those heard at this instant, or at the last before it of which the page tells.
  function heard() {
    let place = shown.place;
    while (place > 0 && !own.senders_m[place]) place -= 1;
    return own.senders_m[place] ?? [];
  }

  let times = 1;
  function follows() {
    for (const name of ["true", "estimated", "senders"]) emptied(parts[name]);
    const truth = was[shown.place];
    const said = scaled(own.said_m[shown.pipeline]?.[shown.place]);
    if (truth) parts.true.add(dots([truth], colourOf("--truth"), 9));
    if (said) {
      const drawn = truth ? said.sub(truth).multiplyScalar(times).add(truth) : said;
      parts.estimated.add(dots([drawn], colourOf("--said"), 6));
      if (truth) parts.estimated.add(lines([truth, drawn], colourOf("--said")));
    }
    const senders = heard().map(scaled);
    if (senders.length) {
      parts.senders.add(dots(senders, "#d9a916", 6));
      const here = truth ?? said;
      if (here) parts.senders.add(lines(senders.flatMap((each) => [here, each]), "#d9a916"));
    }
    stage.tell({ poses: [truth && "true", said && "estimated"].filter(Boolean).join(" "),
      heard: senders.length });
  }

  stage.bar.append(choice("difference", [1, 1e3, 1e4, 1e5, 1e6].map((x) =>
    [x, `× ${x.toLocaleString("en")}`]), (value) => { times = Number(value); follows(); }));
  stage.bar.append(button("orbit", () => stage.lookAt(new Vector3(), reach, from)),
    button("all satellites", () => stage.lookAt(new Vector3(), farthest, from)),
    button("closer", () => stage.closer(0.8)), button("farther", () => stage.closer(1.25)));
  home.querySelector(".note").textContent =
    "In the inertial frame, the Earth's axis up; the Earth does not turn here. Cyan: the satellite "
    + "as it was; green: as estimated, its difference from the truth enlarged by the factor chosen. "
    + "Yellow: the satellites whose signals were received. Grey: the way flown.";
  follow(follows);
  stage.lookAt(new Vector3(), reach, from);
}
