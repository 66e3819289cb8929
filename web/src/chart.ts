// Load over displacement, with the interval of the peak load.

import type { StrengthReport } from "./api";
import { fixed, svg } from "./dom";

/** A step of 1, 2 or 5 times a power of ten that gives about four lines. */
function step(most: number): number {
  const unit = 10 ** Math.floor(Math.log10(most / 4));
  return [1, 2, 5, 10].map((k) => k * unit).find((s) => most / s <= 5) ?? 10 * unit;
}

/** The chart, with every state of the test as a thin line, and what moves its mark to a displacement and a load. */
export function chart(report: StrengthReport, states: [number, number][]): { made: SVGElement; mark: (u: number, f: number) => void } {
  const [w, h, left, bottom, right, top] = [360, 230, 52, 34, 12, 12];
  const far = Math.max(...report.curve.map((p) => p[0]), 1e-9) * 1.05;
  const most = Math.max(report.high_n, ...report.curve.map((p) => p[1]), 1e-9) * 1.08;
  const x = (u: number) => left + ((w - left - right) * u) / far;
  const y = (f: number) => h - bottom - ((h - bottom - top) * f) / most;
  const made = svg("svg", { class: "chart", viewBox: `0 0 ${w} ${h}`, role: "img", "aria-label": `Load over displacement: the peak is ${fixed(report.peak_load_n, 0)} N at ${fixed(report.peak_displacement_mm, 3)} mm` });
  made.append(svg("rect", { x: left, y: y(report.high_n), width: w - left - right, height: Math.max(y(report.low_n) - y(report.high_n), 0), fill: "#e0a860", opacity: 0.3 }));
  const grid = (value: number, isLoad: boolean, digits: number) => {
    made.append(isLoad ? svg("path", { d: `M${left} ${y(value)}H${w - right}`, stroke: "#8884" }) : svg("path", { d: `M${x(value)} ${h - bottom}V${top}`, stroke: "#8884" }));
    const label = isLoad ? svg("text", { x: left - 6, y: y(value) + 4, "text-anchor": "end" }) : svg("text", { x: x(value), y: h - bottom + 15, "text-anchor": "middle" });
    label.textContent = fixed(value, digits);
    made.append(label);
  };
  for (const [end, isLoad] of [[most, true], [far, false]] as const) {
    const by = step(end);
    const digits = Math.max(0, -Math.floor(Math.log10(by) + 1e-9));
    for (let k = 0; k * by <= end; k++) grid(k * by, isLoad, digits);
  }
  const points = (all: [number, number][]) => all.map((p) => `${fixed(x(Math.min(p[0], far)), 1)},${fixed(y(p[1]), 1)}`).join(" ");
  made.append(svg("polyline", { points: points(states), fill: "none", stroke: "#8889", "stroke-width": 1 }));
  made.append(svg("polyline", { points: points(report.curve), fill: "none", stroke: "#2a74b2", "stroke-width": 2.2, "stroke-linejoin": "round" }));
  made.append(svg("path", { d: `M${left} ${y(report.peak_load_n)}H${w - right}`, stroke: "#c0392b", "stroke-dasharray": "5 4" }));
  const axis = svg("text", { x: 0.5 * (left + w - right), y: h - 5, "text-anchor": "middle" });
  axis.textContent = "displacement, mm";
  const force = svg("text", { x: 13, y: 0.5 * (h - bottom), transform: `rotate(-90 13 ${0.5 * (h - bottom)})`, "text-anchor": "middle" });
  force.textContent = "load, N";
  const dot = svg("circle", { r: 5, fill: "#c0392b", stroke: "#fff", "stroke-width": 1.5, id: "mark" });
  made.append(axis, force, dot);
  const mark = (u: number, f: number) => { dot.setAttribute("cx", fixed(x(Math.min(u, far)), 1)); dot.setAttribute("cy", fixed(y(f), 1)); };
  return { made, mark };
}
