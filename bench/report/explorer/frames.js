// Which frame and whose estimate is shown: one state that picture, plots and scene follow.

const data = JSON.parse(document.getElementById("explorer-data").textContent);
const { uPlot, three } = globalThis.explorerLibraries;
const byId = (name) => document.getElementById(`explorer-${name}`);
const shown = { place: 0, pipeline: data.leading, run: 0 };
const followers = [];

// What a pipeline said in the run that is shown: verdicts, reasons and poses by frame.
function runNow() {
  const own = data.pipelines[shown.pipeline];
  return shown.run === 0 ? own : own.runs[shown.run - 1] ?? own;
}
function verdictNow() {
  const { verdicts, sizes } = runNow();
  if (verdicts[shown.place] !== null) return verdicts[shown.place];
  const [millimetres, degrees] = sizes.map((values) => digits(values[shown.place]));
  return `position error ${millimetres} mm; attitude ${degrees} deg`;
}
const posesNow = () => runNow().poses;

const colourOf = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();

function follow(follower) {
  followers.push(follower);
}

function show(change) {
  Object.assign(shown, change);
  shown.place = Math.min(Math.max(0, shown.place), data.frames.length - 1);
  for (const follower of followers) follower();
}

function made(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

// A checkbox with its words; `changed` is told whether it is on.
function toggle(words, on, changed) {
  const box = made("input", { type: "checkbox", checked: on });
  box.addEventListener("change", () => changed(box.checked));
  return made("label", {}, box, ` ${words}`);
}

function choice(words, options, changed) {
  const select = made("select", {}, ...options.map(([value, text]) =>
    made("option", { value, textContent: text })));
  select.addEventListener("change", () => changed(select.value));
  return made("label", {}, `${words} `, select);
}

function button(words, pressed) {
  const element = made("button", { type: "button", textContent: words });
  element.addEventListener("click", pressed);
  return element;
}

// Three digits, as the page's tables have them.
function digits(value) {
  if (value === null || value === undefined) return "–";
  const size = Math.abs(value);
  if (size < 1e-5) return "0";
  const places = Math.max(0, 2 - Math.floor(Math.log10(size)));
  return value.toFixed(Math.min(places, 8)).replace("-", "−");
}
