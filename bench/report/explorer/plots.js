// Numbers against time, with the frame that is shown; a click goes to a frame.

const PIPELINE_COLOURS = { best: "--plot-best", paper: "--plot-paper" };
const OTHER_COLOURS = ["--plot-3", "--plot-4", "--plot-5", "--plot-6"];
const HEIGHT = 210; // px
const WHOLE = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000];
const FONT = '12px "Source Sans 3", "Segoe UI", "Helvetica Neue", Arial, sans-serif';

// What a line shows: of a line of all runs, the one chosen.
function valuesNow(line) {
  if (line.size === undefined || shown.run === 0) return line.values;
  return data.pipelines[line.pipeline].runs[shown.run - 1]?.sizes[line.size] ?? line.values;
}

function startPlots() {
  const home = byId("plots");
  const labels = Object.keys(data.pipelines);
  const others = labels.filter((each) => !(each in PIPELINE_COLOURS));
  const times = data.frames.map((each) => each.time_s);
  const plots = [];

  function variable(line, number) {
    if (!line.pipeline) return number ? "--plot-lit" : "--plot-none";
    return PIPELINE_COLOURS[line.pipeline] ??
      OTHER_COLOURS[others.indexOf(line.pipeline) % OTHER_COLOURS.length];
  }

  // The series that a line needs: a band or a bound is two.
  function seriesOf(line, colour) {
    const many = times.length > 80;
    const base = { stroke: colour, width: 1.5, points: { show: false } };
    if (line.kind === "line") return [{ ...base, points: { show: !many, size: 5, fill: colour } }];
    if (line.kind === "dots") {
      return [{ ...base, paths: () => null, points: { show: true, size: many ? 3 : 5, fill: colour } }];
    }
    if (line.kind === "level") return [{ ...base, width: 1, dash: [6, 4] }];
    if (line.kind === "steps") return [{ ...base, paths: uPlot.paths.stepped({ align: 1 }) }];
    if (line.kind === "bound") return [0, 1].map(() => ({ ...base, width: 1, dash: [3, 3] }));
    return [0, 1].map(() => ({ ...base, width: 0.5 }));
  }

  const twice = (line) => ["band", "bound", "range"].includes(line.kind);
  const negated = (values) => values.map((value) => value === null ? null : -value);
  const columns = (line) => {
    if (!twice(line)) return [valuesNow(line)];
    line.other ??= line.upper ?? negated(line.values);
    return [valuesNow(line), line.other];
  };

  // What others state of themselves would bury the errors: it is there when asked for.
  const shownFirst = (line) =>
    !line.pipeline || line.pipeline === data.leading || ["line", "steps"].includes(line.kind);

  function wantsLog(plot) {
    const oneSided = (line) => line.kind === "range" || !(twice(line) || line.kind === "steps");
    if (!plot.lines.every(oneSided)) return false;
    const there = plot.lines.flatMap((line) => [line.values, line.upper ?? []].flat())
      .filter((value) => value !== null);
    const least = there.reduce((x, y) => Math.min(x, y), Infinity);
    const most = there.reduce((x, y) => Math.max(x, y), -Infinity);
    return there.length > 0 && least > 0 && most > 100 * least;
  }

  function build(own) {
    own.uplot?.destroy();
    own.holder.replaceChildren();
    const values = [times], series = [{}], bands = [];
    own.plot.lines.forEach((line, number) => {
      const colour = colourOf(variable(line, number));
      own.swatches[number].style.color = colour;
      const first = series.length;
      own.first[number] = first;
      seriesOf(line, colour).forEach((each) =>
        series.push({ ...each, show: own.boxes[number].checked }));
      values.push(...columns(line));
      if (line.kind === "band" || line.kind === "range") bands.push({ series: [first, first + 1], fill: `${colour}26` });
    });
    const ink = colourOf("--soft"), grid = colourOf("--line");
    const axis = { stroke: ink, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid } };
    const log = wantsLog(own.plot), counts = own.plot.lines.every((line) => line.kind === "steps");
    own.uplot = new uPlot({
      width: Math.max(200, own.holder.clientWidth),
      height: HEIGHT,
      legend: { show: false },
      cursor: { drag: { x: true, y: false }, points: { show: false } },
      scales: { x: { time: false }, y: log ? { distr: 3 } : counts ? { range: (_, __, most) => [0, 1.1 * most + 1] } : {} },
      axes: [{ ...axis, size: 30, label: "time, s", labelSize: 18, labelGap: 0 },
        { ...axis, size: 62, ...(counts && { incrs: WHOLE }) }].map((each) => ({ ...each, font: FONT, labelFont: FONT,
        values: (_, ticks) => ticks.map((tick) =>
          tick === null ? "" : String(Number(tick.toPrecision(6))).replace("-", "−")) })),
      series,
      bands,
      hooks: {
        draw: [(uplot) => drawLost(uplot)],
        setScale: [() => place(own)],
        setSize: [() => place(own)],
        ready: [(uplot) => listen(uplot, own)],
      },
    }, values, own.holder);
    place(own);
  }

  function listen(uplot, own) {
    own.now = made("div", { className: "now" });
    uplot.over.append(own.now);
    own.uplot = uplot;
    place(own);
    let from = 0;
    uplot.over.addEventListener("mousedown", (event) => { from = event.clientX; });
    uplot.over.addEventListener("click", (event) => {
      if (Math.abs(event.clientX - from) < 4 && uplot.cursor.idx !== null) {
        show({ place: uplot.cursor.idx });
      }
    });
  }

  // Frames without a pose, at the foot of every plot.
  function drawLost(uplot) {
    const { left, top, width, height } = uplot.bbox, pen = uplot.ctx;
    pen.save();
    pen.strokeStyle = colourOf("--red");
    pen.lineWidth = 1.5;
    pen.beginPath();
    runNow().reasons.forEach((reason, number) => {
      if (reason === null) return;
      const x = uplot.valToPos(times[number], "x", true);
      if (x < left || x > left + width) return;
      pen.moveTo(x - 4, top + height - 10);
      pen.lineTo(x + 4, top + height - 2);
      pen.moveTo(x + 4, top + height - 10);
      pen.lineTo(x - 4, top + height - 2);
    });
    pen.stroke();
    pen.restore();
  }

  function place(own) {
    if (!own.uplot || !own.now) return;
    own.behind = false;
    const x = own.uplot.valToPos(times[shown.place], "x");
    own.now.style.transform = `translateX(${x}px)`;
    own.now.hidden = !(x >= 0 && x <= own.uplot.bbox.width / uPlot.pxRatio);
    own.now.dataset.frame = data.frames[shown.place].frame;
    own.values.forEach((each, number) => {
      const line = own.plot.lines[number], values = [valuesNow(line), ...(line.upper ? [line.upper] : [])];
      const told = line.kind === "steps" ? (count) => String(count ?? "–") : digits;
      put(each, values.map((one) => told(one[shown.place])).join(" to "));
    });
  }

  data.plots.forEach((plot) => {
    const own = { plot, first: [], boxes: [], swatches: [], values: [], holder: made("div") };
    own.holder.style.minHeight = `${HEIGHT}px`;
    const words = plot.unit ? `${plot.title}, ${plot.unit}` : plot.title;
    const legend = made("div", { className: "legend" });
    plot.lines.forEach((line, number) => {
      own.swatches.push(made("span", { className: `swatch ${line.kind}` }));
      own.values.push(made("span", { className: "value" }));
      const label = toggle(line.label, shownFirst(line), (on) => {
        const first = own.first[number];
        own.uplot.setSeries(first, { show: on });
        if (twice(line)) own.uplot.setSeries(first + 1, { show: on });
      });
      own.boxes.push(label.querySelector("input"));
      label.prepend(own.swatches[number]);
      label.append(" ", own.values[number]);
      legend.append(label);
    });
    own.holder.setAttribute("role", "img");
    own.holder.setAttribute("aria-label", `${words}, against time; its numbers of the frame shown stand below`);
    home.append(made("figure", { className: "timeplot" },
      made("figcaption", { textContent: words }), own.holder, legend));
    plots.push(own);
  });
  home.hidden = plots.length === 0;
  // What is out of sight is built when there is time for it, and drawn anew once it is seen.
  function refresh(own) {
    if (!own.uplot) build(own);
    else if (own.stale === "values") own.uplot.setData([times, ...own.plot.lines.flatMap(columns)]);
    else if (own.stale) own.uplot.redraw(false);
    own.stale = null;
    if (own.behind) place(own);
  }
  const near = new IntersectionObserver((entries) => entries.forEach((entry) => {
    const own = plots.find((each) => each.holder === entry.target);
    own.near = entry.isIntersecting;
    if (own.near) refresh(own);
  }), { rootMargin: "200px" });
  plots.forEach((own) => near.observe(own.holder));
  function buildNext() {
    const own = plots.find((each) => !each.uplot);
    if (!own) return;
    build(own);
    later(buildNext);
  }
  later(buildNext);
  addEventListener("beforeprint", () => plots.forEach(refresh));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plots.forEach(build));

  const lostNow = () => runNow().reasons.map((reason) => reason === null ? 0 : 1).join("");
  let { run, pipeline } = shown, lost = lostNow(), catchingUp = false;
  function chosenAnew() {
    const lostBefore = lost;
    lost = lostNow();
    for (const own of plots) {
      if (run !== shown.run && own.plot.lines.some((line) => line.size !== undefined)) own.stale = "values";
      else if (lost !== lostBefore) own.stale ??= "lost";
      if (own.near && own.stale) refresh(own);
    }
    ({ run, pipeline } = shown);
  }
  // Plots in sight follow at once, the others when the slider rests.
  follow(() => {
    if (run !== shown.run || pipeline !== shown.pipeline) chosenAnew();
    for (const own of plots) {
      if (own.near) place(own);
      else own.behind = true;
    }
    if (catchingUp) return;
    catchingUp = true;
    later(() => {
      catchingUp = false;
      plots.forEach((own) => { if (own.behind) place(own); });
    });
  });
  const resized = new ResizeObserver(() => plots.forEach((own) => {
    const width = Math.max(200, own.holder.clientWidth);
    if (own.uplot && own.uplot.width !== width) own.uplot.setSize({ width, height: HEIGHT });
  }));
  resized.observe(home);
}
