// Marks on the picture: the same signs and colours as on the page's still pictures.

const TONES = { detections: "#ff4d40", reprojections: "#4ade60", truth: "#46d6ff",
  tracks: "#4ade60" };
const DIM = "#b0564e";
const layerIsOn = {};

function layersNow() {
  const own = data.pipelines[shown.pipeline].layers[shown.place] ?? [];
  return [...(data.true_layers[shown.place] ?? []), ...own];
}

function drawLayers(pen, toScreen) {
  const drawn = [];
  for (const layer of layersNow()) {
    if (layerIsOn[layer.name] === false) continue;
    drawn.push(layer.name);
    layer.places_px.forEach((place, number) => {
      pen.strokeStyle = layer.dim[number] ? DIM : TONES[layer.name] ?? "#ffffff";
      pen.lineWidth = 1.5;
      pen.beginPath();
      if (layer.sign === "lines") {
        for (let k = 0; k < place.length; k += 2) pen.lineTo(...toScreen(place[k], place[k + 1]));
      } else {
        drawSign(pen, layer.sign, toScreen(place[0], place[1]), layer.dim[number] ? 5 : 8);
      }
      pen.stroke();
      if (layer.labels.length && layerIsOn.labels !== false) {
        const [x, y] = toScreen(place[0], place[1]);
        pen.font = "12px sans-serif";
        pen.lineWidth = 3;
        pen.strokeStyle = "#000000";
        pen.strokeText(layer.labels[number], x + 13, y - 9);
        pen.fillStyle = TONES[layer.name] ?? "#ffffff";
        pen.fillText(layer.labels[number], x + 13, y - 9);
      }
    });
  }
  return drawn;
}

function drawSign(pen, sign, [x, y], reach) {
  if (sign === "circle") {
    pen.arc(x, y, reach, 0, 2 * Math.PI);
  } else if (sign === "diamond") {
    const r = 1.7 * reach;
    pen.moveTo(x + r, y);
    for (const [a, b] of [[0, r], [-r, 0], [0, -r], [r, 0]]) pen.lineTo(x + a, y + b);
  } else {
    for (const [a, b] of [[1, 0], [0, 1], [-1, 0], [0, -1]]) {
      pen.moveTo(x + 1.9 * reach * a, y + 1.9 * reach * b);
      pen.lineTo(x + 2.7 * reach * a, y + 2.7 * reach * b);
    }
  }
}
