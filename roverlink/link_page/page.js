// Shows the state of bridges. The server sends the list of all bridges with their alarms, and the state, values and log of
// the bridge that this browser has selected. The page keeps what the user acknowledged, if it has no token.
"use strict";

const byId = (id) => document.getElementById(id);
const LOST_MS = 6000; // the server sends something at least every two seconds
const LOG_LINES = 200;
const FIELDS_SHOWN = 6; // of a row, until the user asks for all
const GAP_S = 4; // a longer pause interrupts the curve

let page = null; // what the server allows, and the bridge that it shows
let overview = { bridges: [], warnings: [], alarms: [], worst: null };
let state = null; // the last state of the selected bridge
let clock = { now: 0, at: 0 }; // seconds of the server's clock, at milliseconds of performance.now()
let lastEventAt = performance.now();
let lastEventTime = new Date();
let values = new Map(); // row -> field -> value
let lastLogNumber = 0;
let beeps = 0;
let events; // the connection

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

const now = () => clock.now + (performance.now() - clock.at) / 1000;
function setClock(time) {
  clock = { now: time, at: performance.now() };
}

// Private windows may refuse to keep anything; then a value holds until the page is closed.
function stored(storage, name) {
  try {
    return window[storage].getItem(name) ?? "";
  } catch {
    return "";
  }
}
function store(storage, name, value) {
  try {
    window[storage].setItem(name, value);
  } catch {
    // as above
  }
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

// --- the worst state ---

// Signs and words for the states that the bridge's side has computed, for sunlight and for those who see no colours.
const SIGNS = {
  OK: "✓ OK",
  alive: "✓ alive",
  WAITING: "… WAITING",
  WARN: "! WARN",
  SILENT: "✕ SILENT",
  silent: "✕ SILENT",
  ERROR: "✕ ERROR",
  STOP: "■ STOP",
  REST: "■ at rest",
  IDLE: "no message yet",
  never: "no message yet",
  listens: "only receives",
  UNKNOWN: "? UNKNOWN",
};
const COLOURS = { OK: "#006b24", WARN: "#d98e00", SILENT: "#c00000", ERROR: "#c00000" };

const isConnected = () => events?.readyState === EventSource.OPEN && performance.now() - lastEventAt <= LOST_MS;

// Returns the worst of what the bridge's side has computed and of the connection, which only the browser knows.
function worstWith(computed) {
  if (isConnected()) return computed ?? { level: "WAITING", text: `waiting for the bridge ${wanted() || page?.bridge || ""}`, advice: "" };
  return {
    level: "UNKNOWN",
    text: `no connection to the bridge's page: all of this is old, from ${clockText(lastEventTime)}`,
    advice: "The rover may be moving. Watch it, and have the emergency stop ready. Check the network, then the bridge.",
  };
}

const clockText = (time) => time.toLocaleTimeString([], { hour12: false });

// Shows a state as a badge; without a connection, nothing is known.
function showLevel(node, name) {
  const shown = isConnected() ? name : "UNKNOWN";
  setText(node, SIGNS[shown] ?? shown);
  setClass(node, `level ${shown}`);
}

function showWorst() {
  const worst = worstWith(overview.bridges.find(({ id }) => id === page?.bridge)?.worst);
  showLevel(byId("level"), worst.level);
  setClass(document.querySelector("header"), worst.level);
  const others = overview.alarms.filter(({ bridge, ended }) => bridge === page?.bridge && ended === null).length - 1;
  setText(byId("worst"), others > 0 && isConnected() ? `${worst.text} (and ${others} more)` : worst.text);
  setText(byId("advice"), worst.advice);
  const all = worstWith(overview.bridges.length > 1 ? overview.worst : worst).level;
  const count = newAlarms().length;
  const title = `${count ? `(${count}) ` : ""}${SIGNS[all] ?? all} ${state?.node.name ?? "Link"}`;
  if (document.title !== title) document.title = title;
  const picture = byId("icon-picture"); // part of the page, because an icon of its own would have to name a site
  picture.firstElementChild.setAttribute("fill", COLOURS[all] ?? "#5b6470");
  setText(picture.lastElementChild, (SIGNS[all] ?? "?")[0]);
  const href = `data:image/svg+xml,${encodeURIComponent(new XMLSerializer().serializeToString(picture))}`;
  if (byId("icon").href !== href) byId("icon").href = href;
}

// --- alarms ---

let acknowledged = new Set(); // numbers that this browser has acknowledged

function storedAcknowledgements() {
  try {
    const { session, numbers } = JSON.parse(stored("localStorage", "roverlink-acknowledged"));
    return session === page?.session ? numbers : [];
  } catch {
    return []; // nothing is stored, or another page wrote there
  }
}

async function acknowledge(numbers) {
  if (token) {
    try {
      await ask("acknowledge", numbers);
    } catch (error) {
      setText(byId("alarm-note"), `not acknowledged for all browsers: ${error.message}`);
      return;
    }
  }
  setText(byId("alarm-note"), "");
  const current = new Set(overview.alarms.map((alarm) => alarm.number));
  acknowledged = new Set([...acknowledged, ...storedAcknowledgements(), ...numbers].filter((number) => current.has(number)));
  store("localStorage", "roverlink-acknowledged", JSON.stringify({ session: page.session, numbers: [...acknowledged] }));
  showAlarms();
}

function shownAlarms() {
  const own = new Set([...acknowledged, ...storedAcknowledgements()]);
  return overview.alarms
    .map((alarm) => ({ ...alarm, acknowledged: alarm.acknowledged || own.has(alarm.number) }))
    .filter((alarm) => !alarm.acknowledged || alarm.ended === null);
}
const newAlarms = () => shownAlarms().filter((alarm) => !alarm.acknowledged);

// Several bridges can have one name; host and process tell them apart.
function labelOf(bridge) {
  const alone = overview.bridges.every((other) => other.id === bridge.id || other.name !== bridge.name);
  return alone ? bridge.name : `${bridge.name} (${bridge.place})`;
}

function showAlarms() {
  const alarms = shownAlarms();
  const labels = new Map(overview.bridges.map((bridge) => [bridge.id, labelOf(bridge)]));
  alarms.sort((one, other) => one.acknowledged - other.acknowledged); // the server has put the worst first
  const open = newAlarms();
  syncChildren(
    byId("alarms"),
    alarms,
    (alarm) => alarm.number,
    (alarm) => {
      const item = element("li");
      const button = element("button");
      button.onclick = () => acknowledge([alarm.number]);
      item.append(element("div"), button);
      item.firstChild.append(element("strong"), element("em"), element("span"), element("span"), element("small"));
      return item;
    },
    (item, alarm) => {
      const isOver = alarm.ended !== null;
      setClass(item, isOver ? "over" : alarm.acknowledged ? `${alarm.level} acknowledged` : alarm.level);
      const [subject, bridge, text, advice, times] = item.firstChild.children;
      setText(subject, `${isOver ? "over" : SIGNS[alarm.level] ?? alarm.level}: ${alarm.subject}`);
      setText(bridge, overview.bridges.length > 1 ? labels.get(alarm.bridge) ?? alarm.bridge : "");
      bridge.hidden = !bridge.textContent;
      setText(text, isOver ? `It was: ${alarm.text}` : alarm.text);
      setPart(advice, isOver ? "" : alarm.advice);
      const ago = (time) => ageText(Math.max(0, now() - time));
      setText(
        times,
        isOver
          ? `is over; it began ${ago(alarm.since)} ago and ended ${ago(alarm.ended)} ago`
          : `for ${ago(alarm.since)}${alarm.acknowledged ? ", acknowledged" : ""}`
      );
      item.lastChild.hidden = alarm.acknowledged;
      setText(item.lastChild, token ? "Acknowledge for all" : "Acknowledge");
      item.lastChild.setAttribute("aria-label", `${item.lastChild.textContent} ${alarm.subject}`.trim());
    }
  );
  byId("no-alarms").hidden = alarms.length > 0;
  byId("acknowledge-all").hidden = open.length < 2;
  const over = alarms.filter(({ ended }) => ended !== null).length;
  const counts = [[alarms.length - over, "now"], [over, "over"]].filter(([count]) => count);
  setText(byId("alarm-count"), counts.map(([count, word]) => `${count} ${word}`).join(", "));
  showTabs(open);
  showWorst();
}

function showTabs(open) {
  const tabs = byId("tabs");
  const isKnown = overview.bridges.some(({ id }) => id === page.bridge);
  tabs.hidden = overview.bridges.length < 2 && isKnown;
  syncChildren(
    tabs,
    overview.bridges,
    (bridge) => bridge.id,
    (bridge) => {
      const made = element("a");
      made.href = `#${encodeURI(bridge.id)}`;
      made.append(element("span"), " ", element("span"), " ", element("b"));
      return made;
    },
    (made, bridge) => {
      const [name, level, count] = made.children;
      setText(name, labelOf(bridge));
      showLevel(level, bridge.worst.level);
      const number = open.filter((alarm) => alarm.bridge === bridge.id).length;
      setText(count, number ? `${number} new` : "");
      if (bridge.id === page.bridge) made.setAttribute("aria-current", "page");
      else made.removeAttribute("aria-current");
    }
  );
  setText(byId("warnings"), overview.warnings.join("; "));
  byId("warnings").hidden = !overview.warnings.length;
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
  setText(byId("sound"), audio ? "Turn sound off" : "Turn sound on");
};
byId("acknowledge-all").onclick = () => acknowledge(newAlarms().map((alarm) => alarm.number));

// --- the token ---

let token = stored("sessionStorage", "roverlink-token");

// Asks for what needs the token, or acts with it if there is a content. Throws an error with the server's reason.
async function ask(path, content) {
  const options = { headers: { Authorization: `Bearer ${token}` } };
  if (content !== undefined) Object.assign(options, { method: "POST", body: JSON.stringify(content) });
  const answer = await fetch(path, options);
  if (answer.status === 401) useToken(""); // the server has another token now
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return answer;
}

function useToken(given) {
  token = given;
  store("sessionStorage", "roverlink-token", token);
  setText(byId("unlock"), token ? "Lock" : "Unlock");
  byId("parameter-section").hidden = !token || !page?.sets_parameters;
  if (page) showAlarms();
}

byId("unlock").onclick = () => {
  if (token) {
    useToken("");
    return;
  }
  setText(byId("unlock-note"), "");
  byId("unlock-dialog").showModal();
};
byId("unlock-cancel").onclick = () => byId("unlock-dialog").close();
byId("unlock-form").onsubmit = async (event) => {
  event.preventDefault();
  token = byId("token").value.trim();
  setText(byId("unlock-note"), ""); // it is about the last attempt
  try {
    await showParameters();
    useToken(token);
    byId("unlock-dialog").close();
  } catch (error) {
    useToken("");
    setText(byId("unlock-note"), error.message);
  }
  byId("token").value = "";
};

// --- parameters ---

async function showParameters() {
  const parameters = await (await ask("parameters")).json();
  syncChildren(
    byId("parameters").querySelector("tbody"),
    parameters,
    ({ name }) => name,
    ({ name, description, unit, choices, number }) => {
      const made = element("tr");
      made.append(element("td"), element("td"), element("td"));
      const input = element(choices.length ? "select" : "input");
      for (const choice of choices.length ? ["", ...choices] : []) input.append(element("option", choice));
      if (number) input.inputMode = "numeric";
      input.dataset.number = number;
      input.name = name;
      input.setAttribute("aria-label", `New value of ${name}`);
      const about = element("small", unit ? `${description}, in ${unit}` : description);
      made.children[0].append(element("strong", name), about);
      made.children[2].append(input);
      return made;
    },
    (made, { value }) => setText(made.children[1], String(value))
  );
}

byId("parameters").onsubmit = async (event) => {
  event.preventDefault();
  const given = [...byId("parameters").querySelectorAll("input, select")].filter((input) => input.value.trim());
  const valueOf = ({ value, dataset }) =>
    dataset.number === "true" && /^-?\d{1,15}$/.test(value.trim()) ? Number(value) : value.trim();
  const note = byId("parameter-note");
  try {
    if (!given.length) throw new Error("enter a new value first");
    await ask("parameters", Object.fromEntries(given.map((input) => [input.name, valueOf(input)])));
    for (const input of given) input.value = "";
    await showParameters();
    setText(note, `set: ${given.map(({ name }) => name).join(", ")}`);
    setClass(note, "");
  } catch (error) {
    setText(note, error.message);
    setClass(note, "refused");
  }
};
// Others can change the parameters too. A lost connection is told above.
setInterval(() => token && page?.sets_parameters && showParameters().catch(() => {}), 5000);

// --- peers and totals ---

const LINK_FAULTS = {
  not_resolved: "✕ host not resolved",
  not_learned: "address not learned yet",
  not_connected: "✕ not connected",
  unreachable: "✕ unreachable",
};
const SCHEMA_TEXTS = { same: "✓ the same protos", differs: "≠ other protos", unknown: "no link message yet" };
const SCHEMA_CLASSES = { same: "OK", differs: "WARN", unknown: "never" };

function showPeers() {
  syncChildren(
    byId("peers"),
    state.peers,
    (peer) => peer.name,
    () => {
      const made = element("div", "", "peer");
      made.append(newEnd(), element("span", "", "stop"), element("span", "", "rest"), element("ul", "", "boards"));
      return made;
    },
    (made, peer) => {
      const [end, stop, rest, boards] = made.children;
      const unsent = peer.unsent ? `; ${peer.unsent} not sent` : "";
      const budget = peer.budget_text ? `; ${peer.budget_text}` : "";
      showEnd(end, peer, `${rateText(peer.rate_in)} in, ${rateText(peer.rate_out)} out${unsent}${budget}`);
      setPart(stop, peer.stopping.length ? `■ told to stop: ${peer.stopping.join(", ")}` : "");
      setPart(rest, peer.resting.length ? `■ at rest, no command yet: ${peer.resting.join(", ")}` : "");
      boards.hidden = !peer.boards.length;
      syncChildren(boards, peer.boards, (board) => board.name, newBoard, (item, board) => showEnd(item.firstChild, board, ""));
    }
  );
}

function newBoard() {
  const made = element("li");
  made.append(newEnd());
  return made;
}

function newEnd() {
  const made = element("div", "", "end");
  made.append(element("strong"), element("span"), element("span"), element("div"), element("div"), element("div"));
  return made;
}

// Shows what peers and boards have in common; `rates` is a text about the messages.
function showEnd(made, end, rates) {
  const [name, shown, fault, facts, schema, statistics] = made.children;
  setText(name, end.name);
  showLevel(shown, end.state);
  setClass(fault, `level ${["unreachable", "not_connected"].includes(end.link) ? "ERROR" : "WARN"}`);
  setPart(fault, end.fault ? `✕ ${end.fault}` : (LINK_FAULTS[end.link] ?? ""));
  const heard = rates ? end.age !== null : end.state === "silent";
  const last = heard ? `last message ${ageText(end.age)} ago` : "";
  setPart(facts, [last, rates, end.address, stampsText(end)].filter(Boolean).join("; "));
  const report = end.report;
  setClass(schema, `schema ${report ? SCHEMA_CLASSES[report.schema] : ""}`);
  setClass(statistics, end.loss_level === "OK" ? "" : end.loss_level);
  setPart(schema, report ? [SCHEMA_TEXTS[report.schema], report.differing].filter(Boolean).join(": ") : "");
  setPart(statistics, report ? statisticsText(report) : "");
}

// Says where the stamps come from, if the table uses the clock of the board.
function stampsText(end) {
  if (end.stamps !== "board") return end.stamps ? "stamps: times of receipt" : "";
  return `stamps: clock of the board ± ${(1000 * end.clock_uncertainty).toFixed(1)} ms`;
}

function setPart(node, text) {
  node.hidden = !text;
  setText(node, text);
}

const NOT_SET_S = -1e9; // the clock of a board without a date counts from its start

function statisticsText(report) {
  const percent = (share) => `${(100 * share).toFixed(1)} %`;
  const seconds = (value) => (Math.abs(value) < 10 ? `${(1000 * value).toFixed(1)} ms` : `${value.toFixed(0)} s`);
  const facts = [
    ["loss in", report.loss_in, percent],
    ["loss out", report.loss_out, percent],
    ["round trip", report.round_trip, seconds],
    ["jitter", report.jitter, seconds],
    ["clock", report.clock_offset, (offset) => (offset < NOT_SET_S ? "not set" : seconds(offset))],
    ["reordered", report.reordered || undefined, String],
    ["duplicates", report.duplicates || undefined, String],
    ["restarts", report.restarts || undefined, String],
    ["senders", report.senders > 1 ? report.senders : undefined, String],
    ["last link message", report.age > 3 ? report.age : undefined, (age) => `${ageText(age)} ago`],
  ];
  return facts
    .filter(([, value]) => value !== undefined)
    .map(([name, value, text]) => `${name} ${text(value)}`.replaceAll(" ", "\u00a0")) // lines break between the facts
    .join("; ");
}

function showTotals() {
  const node = state.node;
  const dropped = sumOf(node, "dropped.") + node.kernel_drops;
  const share = node.received ? ` (${((100 * dropped) / (node.received + node.kernel_drops)).toFixed(2)} %)` : "";
  const facts = [
    ["received", `${node.received} (${rateText(node.received_rate)})`],
    ["lost or dropped", `${dropped}${share}`],
    ["reasons", namesOf(node, "dropped.") || "–"],
    ["dropped by the kernel", String(node.kernel_drops)],
    ["forwarded", namesOf(node, "forwarded.") || "–"],
    ["not sent", namesOf(node, "unsent.") || "–"],
    ["receive buffer", node.socket_size_bytes ? `${Math.round((100 * node.socket_waiting_bytes) / node.socket_size_bytes)} % full` : "–"],
    ["handling, 99 %", node.handling_p99_us === undefined ? "–" : `under ${node.handling_p99_us} µs`],
  ];
  for (const [name, prefix] of [["not delivered", "undelivered."], ["damaged", "damaged."], ["withheld", "withheld."]])
    if (namesOf(node, prefix)) facts.push([name, namesOf(node, prefix)]);
  if (node.recording !== undefined)
    facts.push(["recording", `${node.recording}: ${(node.recording_bytes / 1e6).toFixed(1)} MB, ${node.recording_lost} lost`]);
  const list = byId("totals");
  const cells = facts.flatMap(([name, text]) => [{ tag: "dt", key: `name ${name}`, text: name }, { tag: "dd", key: name, text }]);
  syncChildren(list, cells, (cell) => cell.key, (cell) => element(cell.tag), (made, cell) => setText(made, cell.text));
}

// --- rows ---

const CALM = ["IDLE", "REST"]; // verdicts of rows on which nothing has happened

const expanded = new Set(); // rows that show all fields

function showFields(cell, row) {
  const all = Object.entries(values.get(row.name) ?? {});
  const whole = expanded.has(row.name);
  showPart(cell.firstChild, row, whole ? all : all.slice(0, FIELDS_SHOWN));
  const more = cell.lastChild;
  more.hidden = all.length <= FIELDS_SHOWN;
  setText(more, whole ? "Show fewer fields" : `Show all ${all.length} fields`);
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
      (!byId("active").checked || !CALM.includes(row.verdict) || sumOf(row, "dropped."))
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
      setClass(made, CALM.includes(row.verdict) && !dropped ? "idle" : "");
      setText(name.firstChild, row.name);
      setText(name.lastChild, `${row.number}, ${row.direction.replace("_to_", " → ")}, ${row.topic}`);
      showLevel(shown.firstChild, row.verdict);
      const deadman = row.deadman_after === undefined ? "" : `stops after ${row.deadman_after} s of silence; ${row.stops} stops sent`;
      setText(shown.lastChild, [row.reason, deadman].filter((text) => text && text !== SIGNS[row.verdict]).join("; "));
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
  const query = new URLSearchParams({ bridge: page?.bridge ?? "", row, field });
  try {
    const answer = await (await fetch(`history?${query}`)).json();
    if (plot.row !== row || plot.field !== field || query.get("bridge") !== page?.bridge) return; // the user was faster
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
  const end = now();
  const points = plot.points.filter(([time]) => time >= end - span);
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
  const x = (time) => right - ((end - time) / span) * (right - left);
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
    pen.fillText(back === 0 ? "now" : `−${back} s`, x(end - back), bottom + 6);
    pen.moveTo(x(end - back), top);
    pen.lineTo(x(end - back), bottom);
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
    const time = clockText(new Date(line.time * 1000));
    list.append(element("li", `${time} ${line.level} ${line.text}`, line.level));
    lastLogNumber = line.number;
  }
  while (list.children.length > LOG_LINES) list.firstChild.remove();
  if (atEnd) list.scrollTop = list.scrollHeight; // a reader who has scrolled up stays there
}

// --- events ---

// The part of the URL behind # names the selected bridge.
function wanted() {
  try {
    return decodeURIComponent(location.hash.slice(1));
  } catch {
    return "";
  }
}

function takePage(next) {
  if (page && page.session !== next.session) location.reload(); // the server was started again, perhaps with another page
  page = next;
  byId("unlock").hidden = !page.can_act;
  useToken(page.can_act ? token : "");
  if (token) showParameters().catch(() => {});
  if (plot.row) choosePlot(plot.row, plot.field); // what was missed while there was no connection
}

function takeBridges(next) {
  overview = next;
  setClock(next.now);
  showAlarms();
}

function takeState(next) {
  state = next;
  setClock(next.now);
  setText(byId("name"), state.node.name);
  showState();
  showChoices();
  const row = state.rows.find(({ name }) => name === plot.row);
  if (row && isLinkField(plot.field)) addPoint(state.now, row[plot.field.slice(1)]);
  drawPlot();
}

function showState() {
  showAlarms();
  if (!state) return;
  showPeers();
  showTotals();
  showRows();
}

function takeValues({ now: time, rows }) {
  for (const [row, fields] of Object.entries(rows)) values.set(row, fields);
  if (rows[plot.row] && !(isLinkField(plot.field))) addPoint(time, rows[plot.row][plot.field]);
  if (state) {
    showRows();
    drawPlot();
  }
}

function connectionText() {
  if (!isConnected()) return "NO CONNECTION";
  return state && !state.quiet ? "live" : "not live";
}

function showConnection() {
  const text = connectionText();
  if (byId("connection").textContent === text) return;
  setText(byId("connection"), text);
  setClass(byId("connection"), text === "live" ? "" : "lost");
  setClass(document.querySelector("main"), text === "live" ? "" : "old");
  if (page) showState(); // what is old has no colour
}

function connect() {
  const source = new EventSource(`events?${new URLSearchParams({ bridge: wanted() || (page?.bridge ?? "") })}`);
  events = source;
  const on = (name, take) =>
    source.addEventListener(name, (event) => {
      lastEventAt = performance.now();
      lastEventTime = new Date();
      take(JSON.parse(event.data));
      showConnection();
    });
  on("page", takePage);
  on("bridges", takeBridges);
  on("state", takeState);
  on("values", takeValues);
  on("alive", () => {});
  on("log", ({ lines }) => showLog(lines));
  source.onerror = () => {
    // The browser would try again by itself, but not after an answer that refuses, such as "too many browsers".
    source.close();
    showConnection();
    setTimeout(() => source === events && connect(), 2000);
  };
}

function selectBridge() {
  if (page && [page.bridge, ""].includes(wanted())) return;
  state = null;
  values = new Map();
  expanded.clear();
  Object.assign(plot, { row: "", field: "", points: [] });
  for (const part of [byId("peers"), byId("totals"), byId("rows").tBodies[0], byId("log")]) part.replaceChildren();
  lastLogNumber = 0;
  setText(byId("name"), wanted() || "Link");
  events.close();
  connect();
  if (page) showAlarms(); // nothing of the bridge before must look like a state of this one
}
window.onhashchange = selectBridge;

function setTheme(dark) {
  document.documentElement.classList.toggle("dark", dark);
  setText(byId("theme"), dark ? "Use light colours" : "Use dark colours");
  drawPlot();
}
byId("theme").onclick = () => {
  const dark = !document.documentElement.classList.contains("dark");
  setTheme(dark);
  store("localStorage", "roverlink-dark", dark ? "yes" : "no");
};
setTheme(stored("localStorage", "roverlink-dark") === "yes");

connect();
setInterval(() => {
  showConnection();
  if (!isConnected() || newAlarms().length) beep();
}, 2000);
