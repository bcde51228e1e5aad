"use strict";
// Reads values off the curves: a slider for the keyboard, the mouse over any picture, one cursor in all of them.
(function () {
  const reader = document.getElementById("reader");
  const plots = Array.from(document.querySelectorAll("svg.timed"));
  if (!reader || !plots.length) return;
  const slider = document.getElementById("cursor");
  const told = document.getElementById("instant");
  const columns = Number(slider.max);
  const until = Number(slider.dataset.until);
  const unit = slider.dataset.unit;

  // a path of M, l and v with whole numbers, as lists of [column, step]
  function lines(path) {
    const found = [];
    let x = 0, y = 0, own = [];
    for (const [, command, rest] of path.matchAll(/([Mlv])([^Mlv]*)/g)) {
      const numbers = (rest.match(/-?\d+/g) || []).map(Number);
      if (command === "M") {
        own = [];
        found.push(own);
        [x, y] = numbers;
        own.push([x, y]);
        continue;
      }
      for (let k = 0; k < numbers.length; k += command === "v" ? 1 : 2) {
        if (command === "l") x += numbers[k];
        y += numbers[command === "v" ? k : k + 1];
        own.push([x, y]);
      }
    }
    return found;
  }

  // what the lines of a curve cover in a column: [least, greatest] step, or nothing
  function covered(parts, column) {
    let low = Infinity, high = -Infinity;
    const take = (y) => { low = Math.min(low, y); high = Math.max(high, y); };
    for (const part of parts) {
      let k = 0, end = part.length;
      while (k < end) {
        const middle = (k + end) >> 1;
        if (part[middle][0] < column) k = middle + 1; else end = middle;
      }
      if (k < part.length && part[k][0] === column) {
        for (; k < part.length && part[k][0] === column; k++) take(part[k][1]);
      } else if (k > 0 && k < part.length) {
        const [x0, y0] = part[k - 1], [x1, y1] = part[k];
        take(y0 + (y1 - y0) * (column - x0) / (x1 - x0));
      }
    }
    return low <= high ? [low, high] : null;
  }

  const curves = plots.map((plot) => {
    const low = Number(plot.dataset.low), high = Number(plot.dataset.high), steps = 1000;
    const digits = Math.max(0, Math.min(12, Math.floor(-Math.log10((high - low) / steps))));
    const small = high - low < 1e-4 || Math.max(Math.abs(low), Math.abs(high)) >= 1e6;
    const value = (step) => high - step / steps * (high - low);
    const zero = Math.round(high / (high - low) * steps);
    const number = (step) => Math.abs(step - zero) < 0.6 ? "0" : small ? value(step).toExponential(3) : value(step).toFixed(digits);
    const places = plot.closest("figure").querySelectorAll(".value");
    return Array.from(plot.querySelectorAll(".curve"), (curve, k) => {
      const parts = Array.from(curve.querySelectorAll(".real, .formal")).flatMap((path) => lines(path.getAttribute("d")));
      return (column) => {
        const found = covered(parts, column);
        if (!found) { places[k].textContent = ""; return; }
        const [least, greatest] = [number(found[1]), number(found[0])];
        places[k].textContent = found[1] - found[0] < 3 ? number((found[0] + found[1]) / 2) : least + " to " + greatest;
      };
    });
  }).flat();

  let started = false; // until then the animation shows the largest value
  function show() {
    const column = Number(slider.value);
    const digits = Math.max(0, Math.ceil(-Math.log10(until / columns)));
    const words = (unit ? "t" : "tau") + " = " + (column * until / columns).toFixed(digits) + (unit ? " " + unit : "");
    told.textContent = words;
    slider.setAttribute("aria-valuetext", words);
    for (const plot of plots) {
      const left = Number(plot.dataset.left), right = Number(plot.dataset.right);
      const x = left + (right - left) * column / columns;
      const cursor = plot.querySelector(".cursor");
      cursor.setAttribute("x1", x);
      cursor.setAttribute("x2", x);
      plot.classList.add("read");
    }
    for (const read of curves) read(column);
    if (started) move(column);
  }

  // the animation: parts that sway, or take colours, as the bytes of a frame say
  const moving = document.getElementById("moving");
  const parts = moving ? Array.from(moving.querySelectorAll(".part")) : [];
  function move(column) {
    if (!moving) return;
    const count = Number(moving.dataset.count);
    const frame = Math.round(column / columns * (count - 1));
    parts.forEach((part, k) => {
      const value = (parseInt(moving.dataset.values.substr(2 * (k * count + frame), 2), 16) - 128) / 127;
      const size = Math.abs(value), pale = Math.round(247 * (1 - size));
      if (moving.dataset.sways) part.setAttribute("transform", "translate(" + (90 * value).toFixed(1) + " 0)");
      else part.setAttribute("fill", value > 0 ? "rgb(" + (pale + Math.round(178 * size)) + "," + pale + "," + pale + ")"
        : "rgb(" + pale + "," + pale + "," + (pale + Math.round(168 * size)) + ")");
    });
  }

  const play = document.getElementById("play");
  if (play) {
    let running = 0;
    const stop = () => { clearInterval(running); running = 0; play.textContent = "Play"; };
    play.addEventListener("click", () => {
      if (running) { stop(); return; }
      if (Number(slider.value) >= columns) slider.value = 0;
      play.textContent = "Pause";
      running = setInterval(() => {
        slider.value = Number(slider.value) + Math.max(1, Math.round(columns / 600));
        show();
        if (Number(slider.value) >= columns) stop();
      }, 50);
    });
    play.hidden = false;
  }

  for (const plot of plots) {
    plot.addEventListener("pointermove", (event) => {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(plot.getScreenCTM().inverse()).x;
      const left = Number(plot.dataset.left), right = Number(plot.dataset.right);
      slider.value = Math.round(Math.max(0, Math.min(1, (at - left) / (right - left))) * columns);
      show();
    });
  }
  // wider curves, scrolled so that the cursor is in the middle
  const zoom = document.getElementById("zoom");
  function follow() {
    for (const plot of plots) {
      const figure = plot.closest("figure"), width = plot.viewBox.baseVal.width, left = Number(plot.dataset.left), right = Number(plot.dataset.right);
      const at = (left + (right - left) * Number(slider.value) / columns) / width;
      plot.style.width = zoom.value > 1 ? 100 * zoom.value + "%" : "";
      figure.classList.toggle("zoomed", zoom.value > 1);
      figure.scrollLeft = at * plot.getBoundingClientRect().width - figure.clientWidth / 2;
    }
  }
  zoom.addEventListener("change", follow);
  slider.addEventListener("input", () => { show(); if (zoom.value > 1) follow(); });
  reader.hidden = false;
  for (const value of document.querySelectorAll(".value")) value.hidden = false;
  show();
  started = true;
})();
