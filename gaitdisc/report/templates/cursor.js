"use strict";
// One cursor over all panels: the percent under the pointer, and every curve's value there.
const LEFT = 34, MARGIN = 4, TOP = 15, BOTTOM = 138;
const panels = [...document.querySelectorAll("figure.panel")].map(figure => {
  const svg = figure.querySelector("svg");
  const width = svg.viewBox.baseVal.width, right = width - MARGIN;
  const low = Number(svg.dataset.low), high = Number(svg.dataset.high);
  const curves = [...svg.querySelectorAll("path.mean, path.before")].map(path => ({
    side: path.dataset.side,
    y: path.getAttribute("d").slice(1).trim().split(/\s+/).map(Number).filter((_, i) => i % 2 === 1)
  }));
  return {figure, svg, width, right, low, high, curves, cursor: svg.querySelector(".cursor"), output: figure.querySelector("output")};
});
function show(percent) {
  for (const one of panels) {
    const x = LEFT + percent / 100 * (one.right - LEFT);
    one.cursor.setAttribute("d", "M" + x.toFixed(1) + " " + TOP + "V" + BOTTOM);
    one.cursor.style.visibility = "visible";
    one.output.textContent = " " + percent + " %: " + one.curves.map(curve => {
      if (curve.y[percent] === undefined) return curve.side.toUpperCase() + " –";
      const value = one.low + (BOTTOM - curve.y[percent]) / (BOTTOM - TOP) * (one.high - one.low);
      return curve.side.toUpperCase() + " " + value.toFixed(one.high - one.low < 10 ? 2 : 0);
    }).join(", ");
  }
}
function hide() {
  for (const one of panels) { one.cursor.style.visibility = "hidden"; one.output.textContent = ""; }
}
for (const one of panels) {
  one.svg.addEventListener("pointermove", event => {
    const box = one.svg.getBoundingClientRect();
    const x = (event.clientX - box.left) / box.width * one.width;
    show(Math.max(0, Math.min(100, Math.round((x - LEFT) / (one.right - LEFT) * 100))));
  });
  one.svg.addEventListener("pointerleave", hide);
}
