"""What the page does: figures open enlarged, modes turn. Nothing is loaded from anywhere.

Enlarged, a figure fits the window; wheel, buttons or the keys + - 0 change its size, dragging moves it, Esc
closes (that is the dialog's own). A mode is shown by the offline viewer, which lies in the page as base64 and
is unpacked into a frame only when a button asks for it; the frame is sandboxed and inherits the page's
content policy.
"""

from __future__ import annotations

JAVASCRIPT = """
"use strict";
(() => {
  const dialog = document.getElementById("enlarged");
  const image = dialog.querySelector("img"), words = dialog.querySelector("p");
  const stage = dialog.querySelector(".stage");
  let scale = 1;
  const fit = () =>
    Math.min(stage.clientWidth / image.naturalWidth, stage.clientHeight / image.naturalHeight);
  const size = (wanted) => {
    scale = Math.min(8, Math.max(0.1, wanted));
    image.style.width = scale * image.naturalWidth + "px";
  };
  const grow = (factor) => {
    const x = (stage.scrollLeft + stage.clientWidth / 2) / stage.scrollWidth;
    const y = (stage.scrollTop + stage.clientHeight / 2) / stage.scrollHeight;
    size(factor * scale);
    stage.scrollLeft = x * stage.scrollWidth - stage.clientWidth / 2;
    stage.scrollTop = y * stage.scrollHeight - stage.clientHeight / 2;
  };
  const acts = {
    larger: () => grow(1.4),
    smaller: () => grow(1 / 1.4),
    fit: () => size(fit()),
    close: () => dialog.close(),
  };
  for (const button of document.querySelectorAll("button.zoom")) {
    button.addEventListener("click", () => {
      const small = button.querySelector("img");
      image.src = small.src;
      image.alt = small.alt;
      words.textContent = small.alt;
      dialog.showModal();
      image.decode().then(acts.fit, acts.fit);
    });
  }
  for (const button of dialog.querySelectorAll("button")) {
    button.addEventListener("click", () => acts[button.value]());
  }
  dialog.addEventListener("keydown", (event) => {
    const act = { "+": acts.larger, "=": acts.larger, "-": acts.smaller, "0": acts.fit }[event.key];
    if (act) { act(); event.preventDefault(); }
  });
  stage.addEventListener("wheel", (event) => {
    grow(event.deltaY < 0 ? 1.15 : 1 / 1.15);
    event.preventDefault();
  }, { passive: false });
  let held = null;
  stage.addEventListener("pointerdown", (event) => {
    held = [event.clientX + stage.scrollLeft, event.clientY + stage.scrollTop];
    stage.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  stage.addEventListener("pointermove", (event) => {
    if (held) { stage.scrollLeft = held[0] - event.clientX; stage.scrollTop = held[1] - event.clientY; }
  });
  for (const name of ["pointerup", "pointercancel"]) stage.addEventListener(name, () => { held = null; });
  window.addEventListener("resize", () => { if (dialog.open) acts.fit(); });

  const contents = document.querySelector("nav details");
  if (window.matchMedia("(max-width: 62rem)").matches) contents.open = false;

  if (window.matchMedia("(prefers-reduced-motion: reduce)").matches) {
    for (const film of document.querySelectorAll(".film")) film.open = false;
  }

  const turn = document.querySelector(".turn");
  if (!turn) return;
  const text = (id) => document.getElementById(id).textContent.trim();
  const viewer = () =>
    new TextDecoder().decode(Uint8Array.from(atob(text("viewer")), (letter) => letter.charCodeAt(0)));
  turn.hidden = false;
  for (const button of turn.querySelectorAll("button")) {
    button.addEventListener("click", () => {
      for (const other of turn.querySelectorAll("button")) {
        other.setAttribute("aria-pressed", String(other === button));
      }
      const call = `OfflineLocalView.load(document.body, { base64Str: "${text("scene-" + button.value)}" });`;
      const load = `<scr${""}ipt>function loadDataSet() { ${call} }</scr${""}ipt></body>`;
      const frame = document.createElement("iframe");
      frame.title = button.textContent + ", to be turned with the mouse or a finger";
      frame.setAttribute("sandbox", "allow-scripts");
      frame.srcdoc = viewer().replace("</body>", () => load);
      const old = turn.querySelector("iframe");
      if (old) old.replaceWith(frame); else turn.append(frame);
    });
  }
})();
"""
