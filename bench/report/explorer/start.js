// The bar that moves everything, and the start of all parts.

function startBar() {
  const slider = byId("slider"), now = byId("now"), verdict = byId("verdict");
  const labels = Object.keys(data.pipelines);
  slider.max = data.frames.length - 1;
  slider.addEventListener("input", () => show({ place: Number(slider.value) }));
  byId("back").addEventListener("click", () => show({ place: shown.place - 1 }));
  byId("on").addEventListener("click", () => show({ place: shown.place + 1 }));

  const select = byId("pipeline");
  select.append(...labels.map((label) => made("option", { value: label, textContent: label })));
  select.value = shown.pipeline;
  select.addEventListener("change", () => show({ pipeline: select.value }));
  select.parentElement.hidden = labels.length < 2;

  const run = byId("run");
  const runs = Math.max(...labels.map((label) => data.pipelines[label].runs.length));
  run.append(...Array.from({ length: runs + 1 }, (_, k) =>
    made("option", { value: k, textContent: k })));
  run.addEventListener("change", () => show({ run: Number(run.value) }));
  run.parentElement.hidden = runs < 1;

  // The frame whose first plotted error of this pipeline is largest.
  byId("worst").addEventListener("click", () => {
    const line = data.plots.flatMap((plot) => plot.lines)
      .find((each) => each.pipeline === shown.pipeline && each.kind === "line");
    if (!line) return;
    const sizes = valuesNow(line).map((value) => value === null ? -1 : Math.abs(value));
    show({ place: sizes.indexOf(Math.max(...sizes)) });
  });

  const play = byId("play");
  let playing = null;
  const stop = () => {
    clearInterval(playing);
    playing = null;
    play.textContent = "Play";
  };
  play.addEventListener("click", () => {
    if (playing) {
      stop();
      return;
    }
    if (shown.place === data.frames.length - 1) show({ place: 0 });
    play.textContent = "Stop";
    playing = setInterval(() => {
      show({ place: shown.place + 1 });
      if (shown.place === data.frames.length - 1) stop();
    }, 125);
  });

  follow(() => {
    const { title } = data.frames[shown.place];
    const said = verdictNow();
    slider.value = shown.place;
    slider.setAttribute("aria-valuetext", `${title}: ${said}`);
    put(now, title);
    put(verdict, said);
    verdict.classList.toggle("lost", runNow().reasons[shown.place] !== null);
  });
}

function begin(...starts) {
  for (const start of starts) {
    try {
      start();
    } catch (fault) {
      console.error(start.name, fault);
    }
  }
  show({});
}

byId("section").hidden = false;
byId("scene").hidden = !(hasScene() || (data.orbit && !data.scene));
byId("orbit").hidden = !(data.orbit && data.scene);
begin(startBar, startPicture, startPlots);
byId("section").dataset.ready = "yes";
later(() => begin(startScene, startOrbit)); // without a graphics card they take their time
