"use strict";

const LOST_MS = 3000; // without news from the receiver
const sections = new Map();
let lastEventAt = 0;

function element(name, text = "", className = "") {
  const made = document.createElement(name);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

function sectionOf(name) {
  if (!sections.has(name)) {
    const section = element("section");
    const figure = element("figure");
    const image = element("img");
    image.alt = `newest image of ${name}`;
    image.src = `video/${encodeURIComponent(name)}`;
    image.onclick = () => section.classList.toggle("large");
    image.onerror = () => setTimeout(() => (image.src = `video/${encodeURIComponent(name)}?${Date.now()}`), 1000);
    figure.append(image, element("p", "", "age"));
    section.append(element("h2", name), figure, element("p", "", "numbers"));
    section.setAttribute("aria-label", name);
    document.getElementById("streams").append(section);
    sections.set(name, section);
  }
  return sections.get(name);
}

function ageText(state) {
  if (state.age === null) return `no image yet on UDP port ${state.port}`;
  return `STALE: last image ${state.age.toFixed(1)} s ago`;
}

function numbersText(state) {
  if (state.age === null) return "";
  const percent = (share) => (share === null ? "–" : `${(100 * share).toFixed(1)} %`);
  return [
    `${state.size[0]}×${state.size[1]}`,
    `${state.rate} images/s`,
    `${state.kbit_s} kbit/s`,
    `intact ${percent(state.intact)}`,
    `lost ${percent(state.lost)}`,
    state.latency === null ? "" : `latency ${(1000 * state.latency).toFixed(0)} ms`,
    `from ${state.source}`,
  ]
    .filter(Boolean)
    .join(", ");
}

function show(states) {
  for (const state of states) {
    const section = sectionOf(state.name);
    section.classList.toggle("stale", state.stale);
    const age = section.querySelector(".age");
    age.hidden = !state.stale;
    age.textContent = state.stale ? ageText(state) : "";
    section.querySelector(".numbers").textContent = numbersText(state);
  }
}

function showConnection() {
  const lost = performance.now() - lastEventAt > LOST_MS;
  const text = document.getElementById("connection");
  text.textContent = lost ? "NO CONNECTION to the receiver: the images are old" : "live";
  text.classList.toggle("lost", lost);
  for (const section of lost ? sections.values() : []) section.classList.add("stale");
}

function connect() {
  const events = new EventSource("events");
  events.onmessage = (event) => {
    lastEventAt = performance.now();
    show(JSON.parse(event.data));
    showConnection();
  };
  events.onerror = () => {
    events.close();
    setTimeout(connect, 1000);
  };
}

connect();
setInterval(showConnection, 500);
