// Shows the state of the calibration. The page keeps only the last state and asks for the next one.
"use strict";

const byId = (id) => document.getElementById(id);
let finished = false;
let newest = 0; // number of the last view that was taken
const pause = (ms) => new Promise((done) => setTimeout(done, ms));

function element(tag, text = "", className = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  made.className = className;
  return made;
}

async function post(path) {
  byId("failure").textContent = "";
  try {
    const answer = await fetch(path, { method: "POST" });
    if (!answer.ok) byId("failure").textContent = await answer.text();
  } catch {
    byId("failure").textContent = "no answer; is `roverlink aruco calibrate` still running?";
  }
}

function showCells({ columns, rows, missing }) {
  const cells = byId("cells");
  cells.style.gridTemplateColumns = `repeat(${columns}, 1fr)`;
  cells.style.gridTemplateRows = `repeat(${rows}, 1fr)`;
  const empty = new Set(missing);
  cells.replaceChildren(
    ...Array.from({ length: columns * rows }, (_, cell) => element("div", "", empty.has(cell) ? "empty" : ""))
  );
}

function goalRow({ name, parts }) {
  const row = element("div", "", "goal");
  const chips = element("div", "", "chips");
  chips.append(...parts.map((part) => element("span", part.text, part.done ? "chip done" : "chip")));
  row.append(element("span", name, "name"), chips);
  return row;
}

function viewItem(view) {
  const item = element("li", "", view.bad ? "bad" : "");
  const image = element("img");
  image.src = `views/${view.number}`;
  image.alt = `View ${view.number}`;
  const about = element("div", "", "about");
  about.append(element("strong", `View ${view.number}`), ...view.lines.map((line) => element("div", line, "why")));
  const drop = element("button", "Drop");
  drop.setAttribute("aria-label", `Drop view ${view.number}`);
  drop.onclick = () => post(`views/${view.number}/drop`);
  item.append(image, about, drop);
  item.dataset.shown = JSON.stringify(view);
  return item;
}

function showViews(views) {
  // Unchanged views keep their elements: their images are not loaded again, and clicks on their buttons are not lost.
  const old = new Map([...byId("views").children].map((item) => [item.dataset.shown, item]));
  byId("views").replaceChildren(...views.map((view) => old.get(JSON.stringify(view)) ?? viewItem(view)));
  byId("count").textContent = `(${views.length})`;
  // The person with the board may stand far away: a green frame signals that a view was taken.
  const last = Math.max(0, ...views.map((view) => view.number));
  if (last > newest) byId("screen").animate([{ boxShadow: "0 0 0 .6rem #2fbf4f" }, { boxShadow: "none" }], 900);
  newest = Math.max(newest, last);
}

function tableRow(cells) {
  const row = element("tr");
  row.append(...cells.map((cell) => element("td", cell)));
  return row;
}

const listOf = (texts) => texts.map((text) => element("li", text));

function show(state) {
  finished = state.finished;
  byId("source").textContent = state.source;
  byId("note").textContent = state.note;
  byId("status").textContent = state.status;
  showCells(state.coverage);
  byId("goals").replaceChildren(...state.goals.map(goalRow));
  byId("refused").replaceChildren(...listOf(state.refused));
  byId("take").disabled = !state.can.includes("take");
  byId("calibrate").disabled = !state.can.includes("calibrate");
  byId("save").disabled = !state.can.includes("save");
  byId("legend").hidden = byId("cells").hidden = state.coverage.missing.length === 0;
  byId("result").hidden = !state.result;
  if (state.result) {
    byId("numbers").replaceChildren(...state.result.numbers.map(tableRow));
    byId("remarks").replaceChildren(...listOf(state.result.remarks));
  }
  showViews(state.views);
}

async function followState() {
  let version = 0;
  while (!finished) {
    try {
      const state = await (await fetch(`state?after=${version}`)).json();
      version = state.version;
      show(state);
      await pause(100); // ten times a second is enough for a reader
    } catch {
      byId("note").textContent = "no answer; is `roverlink aruco calibrate` still running?";
      await pause(1000);
    }
  }
}

async function followPicture() {
  // Only one image is requested at a time: a slow link gets fewer images, but never old ones.
  let number = 0;
  while (!finished) {
    try {
      const answer = await fetch(`picture?after=${number}`);
      if (answer.status === 204) continue; // nothing new yet
      if (!answer.ok) throw new Error(answer.statusText);
      number = answer.headers.get("Picture-Number");
      const address = URL.createObjectURL(await answer.blob());
      byId("picture").src = address;
      await byId("picture").decode();
      URL.revokeObjectURL(address);
    } catch {
      await pause(1000);
    }
  }
}

byId("take").onclick = () => post("take");
byId("calibrate").onclick = () => post("calibrate");
byId("save").onclick = () => post("save");
followState();
followPicture();
