// The slider of layers. It draws what page/layers.rs packed; the page needs nothing else and no network.
(async () => {
  "use strict";
  const box = document.getElementById("layers");
  if (!box) return;
  const find = (name) => box.querySelector(`[data-is=${name}]`);
  const about = JSON.parse(document.getElementById("layers-about").textContent);
  const told = find("told");
  if (typeof DecompressionStream === "undefined") {
    told.textContent = "This browser cannot unpack the layers; one of 2023 or later can.";
    return;
  }
  const packed = Uint8Array.from(atob(document.getElementById("layers-data").textContent.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const view = new DataView(await new Response(stream).arrayBuffer());

  // Unpack: header, then layers of paths. Numbers are little-endian; points are steps from the one before.
  let at = 0;
  const u8 = () => view.getUint8(at++);
  const u16 = () => { at += 2; return view.getUint16(at - 2, true); };
  const u32 = () => { at += 4; return view.getUint32(at - 4, true); };
  const f32 = () => { at += 4; return view.getFloat32(at - 4, true); };
  const count = u32(), left = f32(), low = f32(), step = f32();
  const layers = [];
  for (let k = 0; k < count; k++) {
    const layer = { number: u32(), z: f32(), height: f32(), paths: [], beads: 0 };
    for (let paths = u32(); paths > 0; paths--) {
      const role = u8(), beads = u16(), x = [], y = [], width = [];
      let px = 0, py = 0;
      for (let i = 0; i <= beads; i++) {
        px = (px + u16()) & 0xffff; py = (py + u16()) & 0xffff;
        x.push(left + px * step); y.push(low + py * step);
      }
      for (let i = 0; i < beads; i++) width.push(u8() * about.width_step);
      layer.paths.push({ role, x, y, width });
      if (role !== about.travel) layer.beads += beads;
    }
    layers.push(layer);
  }

  const canvas = find("canvas"), pen = canvas.getContext("2d");
  const slider = find("layer"), beads = find("beads"), travels = find("travels"), below = find("below");
  slider.max = String(count - 1);
  slider.value = String(Math.min(about.first, count - 1));
  // The part seen: a window of the plane, moved and scaled by the pointer.
  const [x0, y0, ...size] = about.window;
  let zoom = 1, cx = x0 + size[0] / 2, cy = y0 + size[1] / 2;
  const fit = () => {
    const w = canvas.clientWidth, ratio = window.devicePixelRatio || 1;
    const h = Math.max(220, Math.min(0.72 * window.innerHeight, (w * size[1]) / size[0]));
    canvas.style.height = `${h}px`;
    canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio);
  };
  const scale = () => zoom * 0.94 * Math.min(canvas.width / size[0], canvas.height / size[1]);
  const darker = (colour, share) => `rgb(${colour.map((c) => Math.round(c * share)).join(",")})`;

  const paint = (layer, most, faded) => {
    const s = scale(), X = (x) => canvas.width / 2 + (x - cx) * s, Y = (y) => canvas.height / 2 - (y - cy) * s;
    pen.lineCap = pen.lineJoin = "round";
    let left = most;
    for (const { role, x, y, width } of layer.paths) {
      if (role === about.travel) {
        if (faded || !travels.checked) continue;
        pen.strokeStyle = "rgba(110,190,255,.7)"; pen.lineWidth = 1;
        pen.beginPath(); pen.moveTo(X(x[0]), Y(y[0])); pen.lineTo(X(x[1]), Y(y[1])); pen.stroke();
        continue;
      }
      if (left <= 0) continue;
      const n = Math.min(width.length, left), colour = about.roles[role][1];
      left -= n;
      // Once as wide as the bead and dark, once narrower and bright: the rim shows where beads meet.
      for (const [share, tone] of faded ? [[1, 0.22]] : [[1, 0.5], [0.78, 1]]) {
        pen.strokeStyle = darker(colour, tone);
        let i = 0;
        while (i < n) {
          const w = width[i];
          pen.lineWidth = Math.max(0.7, w * s * share);
          pen.beginPath(); pen.moveTo(X(x[i]), Y(y[i]));
          do { i++; pen.lineTo(X(x[i]), Y(y[i])); } while (i < n && width[i] === w);
          pen.stroke();
        }
      }
    }
  };

  let waiting = false;
  const draw = () => {
    waiting = false;
    const layer = layers[Number(slider.value)];
    const share = Number(beads.value) / Number(beads.max);
    const most = Math.round(share * layer.beads);
    pen.fillStyle = "#1c1e22"; pen.fillRect(0, 0, canvas.width, canvas.height);
    const under = layers[Number(slider.value) - 1];
    if (below.checked && under) paint(under, Infinity, true);
    paint(layer, most, false);
    const s = scale();
    for (const mark of about.marks) {
      if (mark.layer !== Number(slider.value)) continue;
      const x = canvas.width / 2 + (mark.at[0] - cx) * s, y = canvas.height / 2 - (mark.at[1] - cy) * s;
      const r = 9 * (window.devicePixelRatio || 1);
      for (const [colour, wide] of [["#000", 5], ["#fff", 2]]) {
        pen.strokeStyle = colour; pen.lineWidth = wide;
        pen.beginPath(); pen.arc(x, y, r, 0, 2 * Math.PI); pen.moveTo(x - 1.7 * r, y); pen.lineTo(x + 1.7 * r, y); pen.moveTo(x, y - 1.7 * r); pen.lineTo(x, y + 1.7 * r); pen.stroke();
      }
    }
    const text = `layer ${layer.number} of ${about.total}, ${layer.z.toFixed(2)} mm`;
    find("layer-told").textContent = text;
    slider.setAttribute("aria-valuetext", text);
    const part = share < 1 ? `the first ${most} of ${layer.beads} beads` : `all ${layer.beads} beads`;
    find("beads-told").textContent = part;
    beads.setAttribute("aria-valuetext", part);
    canvas.setAttribute("aria-label", `Beads of ${text}: ${part}`);
  };
  const soon = () => { if (!waiting) { waiting = true; requestAnimationFrame(draw); } };
  slider.addEventListener("input", () => { beads.value = beads.max; soon(); });
  for (const input of [beads, travels, below]) input.addEventListener("input", soon);
  for (const button of box.querySelectorAll("[data-mark]")) {
    button.addEventListener("click", () => { slider.value = String(about.marks[Number(button.dataset.mark)].layer); beads.value = beads.max; soon(); });
  }
  find("whole").addEventListener("click", () => { zoom = 1; cx = x0 + size[0] / 2; cy = y0 + size[1] / 2; soon(); });
  const nearer = (factor, x, y) => {
    const s = scale(), dx = (x - canvas.width / 2) / s, dy = (canvas.height / 2 - y) / s;
    const next = Math.min(200, Math.max(0.5, zoom * factor)), k = 1 - zoom / next;
    cx += dx * k; cy += dy * k; zoom = next; soon();
  };
  const ratio = () => canvas.width / canvas.clientWidth;
  canvas.addEventListener("wheel", (e) => { e.preventDefault(); nearer(Math.exp(-e.deltaY / 400), e.offsetX * ratio(), e.offsetY * ratio()); }, { passive: false });
  find("in").addEventListener("click", () => nearer(1.5, canvas.width / 2, canvas.height / 2));
  find("out").addEventListener("click", () => nearer(1 / 1.5, canvas.width / 2, canvas.height / 2));
  let held = null;
  canvas.addEventListener("pointerdown", (e) => { held = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
  canvas.addEventListener("pointermove", (e) => {
    if (!held) return;
    const s = scale() / ratio();
    cx -= (e.clientX - held[0]) / s; cy += (e.clientY - held[1]) / s; held = [e.clientX, e.clientY]; soon();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { held = null; });
  window.addEventListener("resize", () => { fit(); soon(); });
  told.remove();
  find("tools").hidden = false;
  fit(); draw();
})();
