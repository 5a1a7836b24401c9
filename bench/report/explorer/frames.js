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
  const [millimetres, degrees] = sizes.map((values) => values[shown.place]);
  const far = millimetres < 1000 ? `${digits(millimetres)} mm` : `${digits(0.001 * millimetres)} m`;
  return `position error ${far}; attitude ${digits(degrees)} deg`;
}
const posesNow = () => runNow().poses;

// Colours of the page's style, asked for once: each asking would settle the style anew.
let tones = {};
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { tones = {}; });
const colourOf = (name) =>
  tones[name] ??= getComputedStyle(document.body).getPropertyValue(name).trim();

// Work for when nothing else is to be done, or after a second: what is out of sight waits for it.
const later = (work) => globalThis.requestIdleCallback?.(work, { timeout: 1000 })
  ?? setTimeout(work, 50);

// The same words again would lay the page out anew.
function put(element, words) {
  if (element.textContent !== words) element.textContent = words;
}

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
  if (size === 0) return "0";
  if (size < 1e-5) return value.toExponential(2).replaceAll("-", "−");
  const places = Math.max(0, 2 - Math.floor(Math.log10(Number(size.toPrecision(3)))));
  return value.toFixed(Math.min(places, 8)).replace("-", "−");
}
