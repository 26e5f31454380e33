"use strict";

const MAP_MS = 500; // between two requests
const SVG = "http://www.w3.org/2000/svg";
const MARGIN_M = 0.5;

function drawing(name, attributes, text = "") {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  return made;
}

// On the field x points to the right and y up; on the screen y points down.
function pathData(points) {
  return points.map(([x, y], index) => `${index ? "L" : "M"}${x} ${-y}`).join("");
}

function drawGrid(map, left, top, width, height) {
  for (let x = Math.ceil(left); x <= left + width; x += 1) {
    map.append(drawing("path", { class: "grid", d: `M${x} ${top}V${top + height}` }));
    map.append(drawing("text", { x: x + 0.03, y: top + height - 0.05, "font-size": 0.16 }, `${x} m`));
  }
  for (let y = Math.ceil(top); y <= top + height; y += 1) {
    map.append(drawing("path", { class: "grid", d: `M${left} ${y}H${left + width}` }));
    map.append(drawing("text", { x: left + 0.03, y: y - 0.04, "font-size": 0.16 }, `${-y || 0} m`));
  }
}

function draw(field) {
  const map = document.getElementById("map");
  const places = [...field.landmarks.map((one) => one.place), ...field.true, ...field.estimated, ...field.odometry];
  const xs = places.map(([x]) => x);
  const ys = places.map(([, y]) => -y);
  const left = Math.min(...xs) - MARGIN_M;
  const top = Math.min(...ys) - MARGIN_M;
  const width = Math.max(...xs) + MARGIN_M - left;
  const height = Math.max(...ys) + MARGIN_M - top;
  map.replaceChildren();
  map.setAttribute("viewBox", `${left} ${top} ${width} ${height}`);
  drawGrid(map, left, top, width, height);
  for (const path of ["odometry", "true", "estimated"]) {
    map.append(drawing("path", { class: path, d: pathData(field[path]) }));
  }
  for (const { name, place } of field.landmarks) {
    map.append(drawing("rect", { class: "landmark", x: place[0] - 0.06, y: -place[1] - 0.06, width: 0.12, height: 0.12 }));
    map.append(drawing("text", { x: place[0] + 0.1, y: -place[1] + 0.06, "font-size": 0.18 }, name));
  }
  const now = field.estimated.at(-1);
  if (now) map.append(drawing("circle", { class: "rover", cx: now[0], cy: -now[1], r: 0.07 }));
}

function note(field) {
  const now = field.estimated.at(-1);
  if (!now) return "no position yet";
  const beside = (path) => `${(1000 * field.errors[path]).toFixed(0)} mm beside the truth`;
  const camera = `rover at x ${now[0].toFixed(2)} m, y ${now[1].toFixed(2)} m, ${beside("estimated")}`;
  return field.errors.odometry === null ? camera : `${camera}; wheel odometry ${beside("odometry")}`;
}

async function update() {
  try {
    const field = await (await fetch("map")).json();
    draw(field);
    document.getElementById("map-note").textContent = note(field);
  } catch {
    // The demo has ended; the page says so in its first line.
  }
  setTimeout(update, MAP_MS);
}

update();
