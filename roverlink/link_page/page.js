// Shows the state of a bridge. The server sends events; the page keeps the last state, and what the user acknowledged.
"use strict";

const byId = (id) => document.getElementById(id);
const LOST_MS = 15000; // the server sends something at least every five seconds
const LOG_LINES = 200;
const FIELDS_SHOWN = 6; // of a row, until the user asks for all
const GAP_S = 4; // a longer pause interrupts the curve

let state = null; // the last state
let receivedAt = 0; // when it came, in milliseconds of performance.now()
let lastEventAt = performance.now();
let values = new Map(); // row -> field -> value
let lastLogNumber = 0;
let beeps = 0;

function element(tag, text = "", className = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  made.className = className;
  return made;
}

// Texts change only where they differ, so that a selection or a focus of the reader stays.
function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}
function setClass(node, name) {
  if (node.className !== name) node.className = name;
}

// Keeps the elements of known keys, makes new ones, and removes the others.
function syncChildren(parent, items, keyOf, make, update) {
  const old = new Map([...parent.children].map((child) => [child.dataset.key, child]));
  items.forEach((item, index) => {
    const key = String(keyOf(item));
    let child = old.get(key);
    if (!child) {
      child = make(item);
      child.dataset.key = key;
    }
    old.delete(key);
    update(child, item);
    if (parent.children[index] !== child) parent.insertBefore(child, parent.children[index] ?? null);
  });
  old.forEach((child) => child.remove());
}

const rateText = (rate) => `${rate.toFixed(1)}/s`;
const sumOf = (entry, prefix) =>
  Object.entries(entry).reduce((sum, [key, value]) => (key.startsWith(prefix) ? sum + value : sum), 0);
const namesOf = (entry, prefix) =>
  Object.entries(entry)
    .filter(([key, value]) => key.startsWith(prefix) && value)
    .map(([key, value]) => `${key.slice(prefix.length)} ${value}`)
    .join(", ");

function ageText(age) {
  if (age === undefined || age === null) return "–";
  if (age < 60) return `${age.toFixed(1)} s`;
  if (age < 3600) return `${Math.floor(age / 60)} min`;
  return `${Math.floor(age / 3600)} h`;
}

// --- alarms ---

function storedAcknowledgements() {
  try {
    const stored = JSON.parse(localStorage.getItem("roverlink-acknowledged"));
    return stored?.session === state?.session ? new Set(stored?.numbers ?? []) : new Set();
  } catch {
    return new Set(); // another page wrote there, or the browser keeps nothing
  }
}

function acknowledge(numbers) {
  const current = new Set(state.alarms.map((alarm) => alarm.number));
  const kept = [...storedAcknowledgements(), ...numbers].filter((number) => current.has(number));
  memory = new Set(kept);
  try {
    localStorage.setItem("roverlink-acknowledged", JSON.stringify({ session: state.session, numbers: kept }));
  } catch {
    // Private windows may refuse; then the acknowledgement holds until the page is closed.
  }
  showAlarms();
}

let memory = new Set();
const isAcknowledged = (alarm, stored) => memory.has(alarm.number) || stored.has(alarm.number);

function shownAlarms() {
  if (!state) return [];
  const stored = storedAcknowledgements();
  return state.alarms
    .map((alarm) => ({ ...alarm, acknowledged: isAcknowledged(alarm, stored) }))
    .filter((alarm) => !alarm.acknowledged || alarm.ended === null);
}

function showAlarms() {
  const alarms = shownAlarms();
  alarms.sort((one, other) => one.acknowledged - other.acknowledged || other.number - one.number);
  const open = alarms.filter((alarm) => !alarm.acknowledged);
  syncChildren(
    byId("alarms"),
    alarms,
    (alarm) => alarm.number,
    (alarm) => {
      const item = element("li");
      const button = element("button", "Acknowledge");
      button.onclick = () => acknowledge([alarm.number]);
      item.append(element("div"), button);
      item.firstChild.append(element("strong"), element("span"), element("small"));
      return item;
    },
    (item, alarm) => {
      setClass(item, alarm.acknowledged ? `${alarm.level} acknowledged` : alarm.level);
      const [subject, text, times] = item.firstChild.children;
      setText(subject, `${alarm.level}: ${alarm.subject}`);
      setText(text, alarm.text);
      const ago = (time) => ageText(Math.max(0, state.now - time));
      setText(
        times,
        alarm.ended === null
          ? `for ${ago(alarm.since)}${alarm.acknowledged ? ", acknowledged" : ""}`
          : `is over; it began ${ago(alarm.since)} ago and ended ${ago(alarm.ended)} ago`
      );
      item.lastChild.hidden = alarm.acknowledged;
      item.lastChild.setAttribute("aria-label", `Acknowledge ${alarm.subject}`);
    }
  );
  byId("no-alarms").hidden = alarms.length > 0;
  byId("acknowledge-all").hidden = open.length < 2;
  setText(byId("alarm-count"), open.length ? `(${open.length} new)` : "");
  const title = open.length ? `(${open.length}) ${state.node.name}` : state?.node.name ?? "Link";
  if (document.title !== title) document.title = title;
}

let audio = null;
function beep() {
  if (!audio) return;
  const tone = audio.createOscillator();
  const volume = audio.createGain();
  tone.type = "square";
  tone.frequency.value = 880;
  volume.gain.value = 0.2;
  tone.connect(volume).connect(audio.destination);
  tone.start();
  tone.stop(audio.currentTime + 0.25);
  beeps += 1;
}

// Browsers allow sound only after a click, so it is off when the page opens.
byId("sound").onclick = () => {
  if (audio) {
    audio.close();
    audio = null;
  } else {
    audio = new AudioContext();
    beep(); // so that the user hears how loud it is
  }
  byId("sound").setAttribute("aria-pressed", String(audio !== null));
  setText(byId("sound"), audio ? "Sound on" : "Sound off");
};
byId("acknowledge-all").onclick = () => acknowledge(shownAlarms().map((alarm) => alarm.number));

// --- peers and totals ---

const PEER_STATES = {
  alive: "✓ alive",
  silent: "✕ SILENT",
  never: "no message yet",
  listens: "only receives",
};

function showPeers() {
  syncChildren(
    byId("peers"),
    state.peers,
    (peer) => peer.name,
    () => {
      const made = element("div", "", "peer");
      made.append(element("strong"), element("span"), element("div"), element("span"));
      return made;
    },
    (made, peer) => {
      const [name, shown, facts, stop] = made.children;
      setText(name, peer.name);
      setClass(shown, `level ${peer.state}`);
      setText(shown, PEER_STATES[peer.state]);
      const heard = peer.age === null ? "" : `last message ${ageText(peer.age)} ago; `;
      const unsent = peer.unsent ? `; ${peer.unsent} not sent` : "";
      setText(facts, `${heard}${rateText(peer.rate_in)} in, ${rateText(peer.rate_out)} out${unsent}`);
      setClass(stop, "stop");
      stop.hidden = peer.stopping.length === 0;
      setText(stop, `■ told to stop: ${peer.stopping.join(", ")}`);
    }
  );
}

function showTotals() {
  const node = state.node;
  const dropped = sumOf(node, "dropped.") + node.kernel_drops;
  const share = node.received ? ` (${((100 * dropped) / (node.received + node.kernel_drops)).toFixed(2)} %)` : "";
  const facts = [
    ["state", node.message],
    ["received", `${node.received} (${rateText(node.received_rate)})`],
    ["lost or dropped", `${dropped}${share}`],
    ["reasons", namesOf(node, "dropped.") || "–"],
    ["dropped by the kernel", String(node.kernel_drops)],
    ["forwarded", namesOf(node, "forwarded.") || "–"],
    ["not sent", namesOf(node, "unsent.") || "–"],
    ["receive buffer", node.socket_size_bytes ? `${Math.round((100 * node.socket_waiting_bytes) / node.socket_size_bytes)} % full` : "–"],
    ["handling, 99 %", node.handling_p99_us === undefined ? "–" : `under ${node.handling_p99_us} µs`],
  ];
  if (node.recording !== undefined)
    facts.push(["recording", `${node.recording}: ${(node.recording_bytes / 1e6).toFixed(1)} MB, ${node.recording_lost} lost`]);
  const list = byId("totals");
  const cells = facts.flatMap(([name, text]) => [{ tag: "dt", key: `name ${name}`, text: name }, { tag: "dd", key: name, text }]);
  syncChildren(list, cells, (cell) => cell.key, (cell) => element(cell.tag), (made, cell) => setText(made, cell.text));
}

// --- rows ---

function rowState(row) {
  if (row.stopping) return row.count ? ["■ STOP", "stop"] : ["■ at rest", "rest"];
  return row.level === "OK" ? ["✓ OK", "OK"] : [row.level, row.level];
}

const expanded = new Set(); // rows that show all fields

function showFields(cell, row) {
  const all = Object.entries(values.get(row.name) ?? {});
  const whole = expanded.has(row.name);
  showPart(cell.firstChild, row, whole ? all : all.slice(0, FIELDS_SHOWN));
  const more = cell.lastChild;
  more.hidden = all.length <= FIELDS_SHOWN;
  setText(more, whole ? "fewer fields" : `all ${all.length} fields`);
}

function showPart(cell, row, fields) {
  syncChildren(
    cell,
    fields,
    ([field]) => field,
    ([field, value]) => {
      const numeric = typeof value !== "string";
      const made = element(numeric ? "button" : "span");
      made.append(`${field} `, element("b"));
      if (numeric) {
        made.title = "plot";
        made.onclick = () => choosePlot(row.name, field);
      }
      return made;
    },
    (made, [field, value]) => {
      const text = typeof value === "number" && !Number.isInteger(value) ? String(Number(value.toPrecision(6))) : String(value);
      setText(made.lastChild, text);
      setClass(made, plot.row === row.name && plot.field === field ? "chosen" : "");
    }
  );
}

function showRows() {
  const wanted = byId("filter").value.trim().toLowerCase();
  const rows = state.rows.filter(
    (row) =>
      [row.name, row.peer, row.topic].some((text) => text.toLowerCase().includes(wanted)) &&
      (!byId("active").checked || row.count || sumOf(row, "dropped.") || row.level !== "OK")
  );
  syncChildren(
    byId("rows").tBodies[0],
    rows,
    (row) => row.name,
    (row) => {
      const made = element("tr");
      for (const name of ["name", "state", "rate number", "age number", "dropped number", "values"]) {
        const cell = element("td", "", name);
        cell.dataset.label = name.split(" ")[0];
        made.append(cell);
      }
      const [name, shown, , , , fields] = made.children;
      name.append(element("strong"), element("small"));
      shown.append(element("span"), element("small"));
      const more = element("button", "", "more");
      more.onclick = () => {
        if (!expanded.delete(row.name)) expanded.add(row.name);
        showRows();
      };
      fields.append(element("div", "", "fields"), more);
      return made;
    },
    (made, row) => {
      const [name, shown, rate, age, drops, fields] = made.children;
      const dropped = sumOf(row, "dropped.");
      setClass(made, row.count || dropped ? "" : "idle");
      setText(name.firstChild, row.name);
      setText(name.lastChild, `${row.number}, ${row.direction.replace("_to_", " → ")}, ${row.topic}`);
      const [label, kind] = rowState(row);
      setText(shown.firstChild, label);
      setClass(shown.firstChild, `level ${kind}`);
      const deadman = row.deadman_after === undefined ? "" : `stop after ${row.deadman_after} s; ${row.stops} sent`;
      setText(shown.lastChild, [row.message, deadman].filter(Boolean).join("; "));
      setText(rate, rateText(row.rate) + (row.expect_rate === undefined ? "" : ` of ${row.expect_rate}`));
      setText(age, ageText(row.age));
      setText(drops, dropped ? `${dropped} (${namesOf(row, "dropped.")})` : "–");
      showFields(fields, row);
    }
  );
}

byId("filter").oninput = () => state && showRows();
byId("active").onchange = () => state && showRows();

// --- plot ---

const plot = { row: "", field: "", points: [] };
const isLinkField = (field) => field.startsWith("#"); // of the row itself, not of its message
const LINK_FIELDS = { "#rate": "messages a second", "#age": "seconds since the last message" };

function showChoices() {
  const rows = state.rows.map((row) => row.name);
  const option = (value, text) => {
    const made = element("option", text);
    made.value = value;
    return made;
  };
  syncChildren(byId("plot-row"), rows, (name) => name, (name) => option(name, name), () => {});
  if (!rows.includes(plot.row)) choosePlot((state.rows.find((row) => row.count) ?? state.rows[0])?.name ?? "", "#rate");
  const numeric = Object.entries(values.get(plot.row) ?? {}).filter(([, value]) => typeof value !== "string");
  const fields = [...Object.keys(LINK_FIELDS), ...numeric.map(([field]) => field)];
  if (!fields.includes(plot.field)) fields.push(plot.field);
  syncChildren(byId("plot-field"), fields, (field) => field, (field) => option(field, LINK_FIELDS[field] ?? field), () => {});
  byId("plot-row").value = plot.row;
  byId("plot-field").value = plot.field;
}

async function choosePlot(row, field) {
  Object.assign(plot, { row, field, points: [] });
  if (state) showChoices();
  drawPlot();
  const query = new URLSearchParams({ row, field });
  try {
    const answer = await (await fetch(`history?${query}`)).json();
    if (plot.row !== row || plot.field !== field) return; // the user was faster
    const last = answer.points.at(-1)?.[0] ?? -1;
    plot.points = [...answer.points, ...plot.points.filter(([time]) => time > last)];
  } catch {
    // No answer: the line above says that the connection is lost, and new points come with it.
  }
  drawPlot();
}

function addPoint(time, value) {
  if (typeof value === "boolean") value = Number(value);
  if (typeof value !== "number" || !(time > (plot.points.at(-1)?.[0] ?? -1))) return;
  plot.points.push([time, value]);
  while (plot.points[0][0] < time - (state?.history ?? 300)) plot.points.shift();
}

function ticks(low, high, count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= raw) ?? raw;
  const found = [];
  for (let tick = Math.ceil(low / step) * step; tick <= high + step / 1e6 && found.length < 20; tick += step) found.push(tick);
  return found;
}

function drawPlot() {
  const canvas = byId("plot");
  const scale = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  canvas.width = width * scale;
  canvas.height = height * scale;
  const pen = canvas.getContext("2d");
  pen.scale(scale, scale);
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(name).trim();
  const span = Number(byId("plot-span").value);
  const now = state ? state.now + (performance.now() - receivedAt) / 1000 : 0;
  const points = plot.points.filter(([time]) => time >= now - span);
  const label = `${plot.row} ${LINK_FIELDS[plot.field] ?? plot.field}`;
  if (!points.length) {
    setText(byId("plot-note"), `${label}: no values in this time`);
    return;
  }
  const numbers = points.map(([, value]) => value);
  let low = numbers.reduce((one, other) => Math.min(one, other));
  let high = numbers.reduce((one, other) => Math.max(one, other));
  const spell = (number) => String(Number(number.toPrecision(5)));
  setText(byId("plot-note"), `${label}: now ${spell(numbers.at(-1))}, lowest ${spell(low)}, highest ${spell(high)}`);
  const room = (high - low) * 0.05 || Math.abs(high) * 0.1 || 1;
  low -= room;
  high += room;
  const [left, right, top, bottom] = [64, width - 8, 8, height - 24];
  const x = (time) => right - ((now - time) / span) * (right - left);
  const y = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
  pen.font = "13px system-ui, sans-serif";
  pen.fillStyle = colour("--text");
  pen.strokeStyle = colour("--line");
  pen.lineWidth = 1;
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  pen.beginPath();
  for (const tick of ticks(low, high, 5)) {
    pen.fillText(spell(Math.abs(tick) < (high - low) / 1e6 ? 0 : tick), left - 6, y(tick));
    pen.moveTo(left, y(tick));
    pen.lineTo(right, y(tick));
  }
  pen.textBaseline = "top";
  for (let back = 0; back <= span; back += span / 4) {
    pen.textAlign = back === 0 ? "right" : "center";
    pen.fillText(back === 0 ? "now" : `−${back} s`, x(now - back), bottom + 6);
    pen.moveTo(x(now - back), top);
    pen.lineTo(x(now - back), bottom);
  }
  pen.stroke();
  pen.strokeStyle = colour("--curve");
  pen.fillStyle = colour("--curve");
  pen.lineWidth = 2.5;
  pen.lineJoin = "round";
  pen.beginPath();
  points.forEach(([time, value], index) => {
    if (index && time - points[index - 1][0] < GAP_S) pen.lineTo(x(time), y(value));
    else pen.moveTo(x(time), y(value));
  });
  pen.stroke();
  const [time, value] = points.at(-1);
  pen.beginPath();
  pen.arc(x(time), y(value), 4, 0, 7);
  pen.fill();
}

byId("plot-row").onchange = () => choosePlot(byId("plot-row").value, "#rate");
byId("plot-field").onchange = () => choosePlot(plot.row, byId("plot-field").value);
byId("plot-span").onchange = drawPlot;
window.onresize = drawPlot;

// --- log ---

function showLog(lines) {
  const list = byId("log");
  const atEnd = list.scrollTop + list.clientHeight >= list.scrollHeight - 8;
  for (const line of lines.filter(({ number }) => number > lastLogNumber)) {
    const time = new Date(line.time * 1000).toLocaleTimeString([], { hour12: false });
    list.append(element("li", `${time} ${line.level} ${line.text}`, line.level));
    lastLogNumber = line.number;
  }
  while (list.children.length > LOG_LINES) list.firstChild.remove();
  if (atEnd) list.scrollTop = list.scrollHeight; // a reader who has scrolled up stays there
}

// --- events ---

function takeState(next) {
  if (state && state.session !== next.session) location.reload(); // the bridge was started again
  state = next;
  receivedAt = performance.now();
  setText(byId("name"), state.node.name);
  setText(byId("level"), state.quiet ? "STALE" : state.node.level);
  setClass(byId("level"), `level ${byId("level").textContent}`);
  showAlarms();
  showPeers();
  showTotals();
  showRows();
  showChoices();
  const row = state.rows.find(({ name }) => name === plot.row);
  if (row && isLinkField(plot.field)) addPoint(state.now, row[plot.field.slice(1)]);
  drawPlot();
}

function takeValues({ now, rows }) {
  for (const [row, fields] of Object.entries(rows)) values.set(row, fields);
  if (rows[plot.row] && !(isLinkField(plot.field))) addPoint(now, rows[plot.row][plot.field]);
  if (state) {
    showRows();
    drawPlot();
  }
}

function showConnection() {
  const lost = performance.now() - lastEventAt > LOST_MS || events.readyState !== EventSource.OPEN;
  const text = lost ? "NO CONNECTION to the bridge's page" : state?.quiet ? "the bridge no longer reports" : "live";
  setText(byId("connection"), text);
  setClass(byId("connection"), text === "live" ? "" : "lost");
  return lost;
}

let events;
function connect() {
  events = new EventSource("events");
  const on = (name, take) =>
    events.addEventListener(name, (event) => {
      lastEventAt = performance.now();
      take(JSON.parse(event.data));
      showConnection();
    });
  on("state", takeState);
  on("values", takeValues);
  on("alive", () => {});
  on("log", ({ lines }) => showLog(lines));
  events.onerror = () => {
    showConnection();
    // The browser tries again by itself, but not after an answer that refuses, such as "too many browsers".
    if (events.readyState === EventSource.CLOSED) setTimeout(connect, 5000);
  };
}

function setTheme(dark) {
  document.documentElement.classList.toggle("dark", dark);
  byId("theme").setAttribute("aria-pressed", String(dark));
  drawPlot();
}
byId("theme").onclick = () => {
  const dark = !document.documentElement.classList.contains("dark");
  setTheme(dark);
  try {
    localStorage.setItem("roverlink-dark", dark ? "yes" : "no");
  } catch {
    // Private windows may refuse; then the choice holds until the page is closed.
  }
};
try {
  setTheme(localStorage.getItem("roverlink-dark") === "yes");
} catch {
  setTheme(false);
}

connect();
setInterval(() => {
  const lost = showConnection();
  if (lost || shownAlarms().some((alarm) => !alarm.acknowledged)) beep();
}, 2000);
