"use strict";
// The Sun map as a globe seen from outside: each frame where its Sun stands, turned by mouse, touch
// and keys. Frames and verdicts are read from the plane, which stays for those without scripts.

(() => {
  const DEG = Math.PI / 180, TILE_PX = 128, SIDE = 0.94, LARGEST = 0.35, DRAG_PX = 4;
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0]];
  const colourOf = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();

  // Towards an azimuth, clockwise from +y seen from +z, and an elevation; north of there; and what
  // lies to the right of north for who looks at it from outside.
  function axesAt(azimuth, elevation) {
    const [s, c, up, level] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(elevation),
      Math.cos(elevation)];
    const away = [s * level, c * level, up], north = [-s * up, -c * up, level];
    return { away, north, right: cross(north, away) };
  }

  // A frame with its edge, as one picture.
  function tileOf(link, changed) {
    const { azimuth, elevation, colour } = link.dataset;
    const still = document.createElement("canvas");
    still.width = still.height = TILE_PX;
    const pen = still.getContext("2d"), image = new Image();
    image.onload = () => {
      pen.drawImage(image, 0, 0, TILE_PX, TILE_PX);
      pen.strokeStyle = colour;
      pen.lineWidth = 0.14 * TILE_PX;
      pen.strokeRect(0, 0, TILE_PX, TILE_PX);
      changed();
    };
    image.src = document.querySelector(`${link.hash} img`).src;
    return { link, still, ...axesAt(azimuth * DEG, elevation * DEG) };
  }

  function startGlobe(home) {
    const canvas = home.querySelector("canvas"), pen = canvas.getContext("2d");
    const facingLink = home.querySelector("a"), told = home.querySelector(".readout");
    const links = [...document.querySelectorAll(`#${home.dataset.plane} a`)];
    let azimuth = 0, elevation = 25 * DEG, zoom = 1, size = 0, asked = 0;
    const tiles = links.map((link) => tileOf(link, render));
    let least = 2;
    tiles.forEach((one, k) => tiles.slice(k + 1).forEach((other) => {
      least = Math.min(least, Math.acos(Math.min(1, dot(one.away, other.away))));
    }));
    const half = Math.min(LARGEST, Math.tan(0.5 * SIDE * least));

    const radius = () => 0.41 * size * zoom;
    function view() {
      const { away, north, right } = axesAt(azimuth, elevation);
      return { away, at: (p, far = radius()) =>
        [0.5 * size + far * dot(p, right), 0.5 * size - far * dot(p, north)],
        along: (p) => [dot(p, right), -dot(p, north)] };
    }
    const facing = (away) => tiles.reduce((best, one) =>
      dot(one.away, away) > dot(best.away, away) ? one : best);

    function net({ away, at }) {
      pen.strokeStyle = colourOf("--edge");
      pen.lineWidth = 0.7;
      pen.beginPath();
      const line = (place) => {
        let on = false;
        for (let k = 0; k <= 72; k++) {
          const p = place(k * 5 * DEG), seen = dot(p, away) > 0;
          if (seen && on) pen.lineTo(...at(p));
          else if (seen) pen.moveTo(...at(p));
          on = seen;
        }
      };
      for (let k = 0; k < 6; k++) {
        line((t) => { const { away: a } = axesAt(k * 30 * DEG, 0);
          return [a[0] * Math.cos(t), a[1] * Math.cos(t), Math.sin(t)]; });
      }
      for (let k = -2; k <= 2; k++) line((t) => axesAt(t, k * 30 * DEG).away);
      pen.stroke();
    }

    function names({ away, at }) {
      pen.fillStyle = colourOf("--ink");
      pen.font = "600 14px sans-serif";
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      [["+x", [1, 0, 0]], ["−x", [-1, 0, 0]], ["+y", [0, 1, 0]], ["−y", [0, -1, 0]],
        ["+z", [0, 0, 1]], ["−z", [0, 0, -1]]].forEach(([name, p]) => {
        if (dot(p, away) > -0.3) pen.fillText(name, ...at(p, radius() + 18));
      });
    }

    function draw() {
      const ratio = globalThis.devicePixelRatio || 1, own = view();
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      pen.clearRect(0, 0, size, size);
      pen.fillStyle = colourOf("--faint");
      pen.beginPath();
      pen.arc(0.5 * size, 0.5 * size, radius(), 0, 2 * Math.PI);
      pen.fill();
      net(own);
      const seen = tiles.filter((one) => dot(one.away, own.away) > 0.03)
        .sort((a, b) => dot(a.away, own.away) - dot(b.away, own.away));
      const middle = facing(own.away), reach = half * radius();
      for (const { away, north, right, still, link } of seen) {
        const [x, y] = own.at(away), [a, b] = own.along(right), [c, d] = own.along(north);
        pen.setTransform(ratio * reach * a, ratio * reach * b, -ratio * reach * c,
          -ratio * reach * d, ratio * x, ratio * y);
        pen.drawImage(still, -1, -1, 2, 2);
        if (link === middle.link) {
          pen.strokeStyle = colourOf("--ink");
          pen.lineWidth = 0.12;
          pen.strokeRect(-1.1, -1.1, 2.2, 2.2);
        }
      }
      pen.setTransform(ratio, 0, 0, ratio, 0, 0);
      names(own);
      const words = middle.link.getAttribute("aria-label");
      facingLink.href = middle.link.hash;
      facingLink.textContent = words;
      canvas.setAttribute("aria-label", `Globe of ${tiles.length} Suns; in the middle: ${words}`);
      Object.assign(canvas.dataset, { seen: seen.length, facing: tiles.indexOf(middle),
        view: `${(azimuth / DEG).toFixed(1)} ${(elevation / DEG).toFixed(1)}` });
    }

    function render() {
      asked ||= requestAnimationFrame(() => { asked = 0; draw(); });
    }

    function turn(across, up) {
      azimuth = (azimuth + across) % (2 * Math.PI);
      elevation = Math.max(-90 * DEG, Math.min(90 * DEG, elevation + up));
      render();
    }

    function closer(factor) {
      zoom = Math.max(1, Math.min(6, zoom * factor));
      render();
    }

    // The frame under a place of the canvas.
    function under(x, y) {
      const own = view();
      return tiles.filter((one) => dot(one.away, own.away) > 0.03).find(({ away, north, right }) => {
        const [u, v] = own.at(away), [a, b] = own.along(right), [c, d] = own.along(north);
        const [p, q, area] = [(x - u) / radius(), (y - v) / radius(), a * d - b * c];
        return Math.abs((p * d - q * c) / area) < half && Math.abs((q * a - p * b) / area) < half;
      });
    }

    let held = null, moved = 0;
    canvas.style.touchAction = "pan-y"; // up and down the page scrolls, sideways the globe turns
    canvas.addEventListener("pointerdown", (event) => {
      held = [event.clientX, event.clientY];
      moved = 0;
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!held || event.buttons === 0) {
        const one = under(event.offsetX, event.offsetY);
        canvas.style.cursor = one ? "pointer" : "grab";
        told.textContent = one ? one.link.getAttribute("aria-label") : "";
        return;
      }
      const [x, y] = [event.clientX - held[0], event.clientY - held[1]];
      held = [event.clientX, event.clientY];
      moved += Math.abs(x) + Math.abs(y);
      turn(x / radius(), y / radius());
    });
    canvas.addEventListener("pointerup", (event) => {
      const one = moved < DRAG_PX && held && under(event.offsetX, event.offsetY);
      held = null;
      if (one) location.hash = one.link.hash;
    });
    canvas.addEventListener("pointercancel", () => { held = null; });
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && document.activeElement !== canvas) return; // the page scrolls
      event.preventDefault();
      closer(Math.exp(-0.002 * event.deltaY));
    }, { passive: false });
    const keys = {
      ArrowLeft: () => turn(5 * DEG, 0), ArrowRight: () => turn(-5 * DEG, 0),
      ArrowUp: () => turn(0, 5 * DEG), ArrowDown: () => turn(0, -5 * DEG),
      "+": () => closer(1.25), "=": () => closer(1.25), "-": () => closer(0.8),
      Enter: () => { location.hash = facing(view().away).link.hash; },
    };
    canvas.addEventListener("keydown", (event) => {
      if (!(event.key in keys) || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      keys[event.key]();
    });

    home.hidden = false;
    new ResizeObserver(() => {
      size = Math.min(home.clientWidth - 28, 0.8 * globalThis.innerHeight);
      const ratio = globalThis.devicePixelRatio || 1;
      canvas.style.width = canvas.style.height = `${size}px`;
      canvas.width = canvas.height = Math.round(size * ratio);
      render();
    }).observe(home);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", render);
  }

  document.querySelectorAll(".globe").forEach(startGlobe);
})();
