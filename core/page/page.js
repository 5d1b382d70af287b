(function () {
  "use strict";
  const root = document.documentElement;
  const list = document.getElementById("photo-list");

  function recall(key) { try { return localStorage.getItem(key); } catch (e) { return null; } }
  function remember(key, value) { try { localStorage.setItem(key, value); } catch (e) { /* a page opened from a file may have no storage */ } }

  const theme = recall("skyquilt-theme");
  if (theme) root.dataset.theme = theme;
  document.getElementById("theme").onclick = function () {
    const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
    remember("skyquilt-theme", root.dataset.theme);
  };

  document.addEventListener("input", function (e) {
    const compare = e.target.closest(".compare");
    if (compare && e.target.type === "range") compare.style.setProperty("--x", e.target.value + "%");
  });

  document.querySelectorAll("[data-layer]").forEach(function (box) {
    box.onchange = function () {
      document.querySelectorAll("#map ." + box.dataset.layer).forEach(function (g) { g.style.display = box.checked ? "" : "none"; });
      if (box.dataset.layer === "layer-ortho") document.getElementById("map").classList.toggle("over-image", box.checked);
    };
  });

  document.querySelectorAll("[data-view]").forEach(function (button) {
    button.onclick = function () {
      document.querySelectorAll("[data-view]").forEach(function (b) { b.classList.toggle("on", b === button); });
      list.classList.toggle("sliding", button.dataset.view === "slide");
    };
  });

  const order = document.getElementById("order");
  if (order) {
    order.onchange = function () {
      const sign = order.value === "best" ? -1 : 1;
      const cards = Array.from(list.children);
      cards.sort(function (a, b) {
        if (order.value === "name") return a.dataset.order - b.dataset.order;
        return sign * ((a.dataset.psnr || 1e9) - (b.dataset.psnr || 1e9));
      });
      cards.forEach(function (card) { list.appendChild(card); });
    };
  }

  document.querySelectorAll("table.sortable th").forEach(function (th) {
    th.onclick = function () {
      const table = th.closest("table"), column = th.cellIndex, body = table.tBodies[0];
      const numeric = th.classList.contains("num");
      const down = th.classList.contains("up") || (!th.classList.contains("down") && numeric);
      table.querySelectorAll("th").forEach(function (other) { other.classList.remove("up", "down"); });
      th.classList.add(down ? "down" : "up");
      function key(row) {
        const cell = row.cells[column];
        return cell.dataset.v !== undefined ? cell.dataset.v : cell.textContent;
      }
      const rows = Array.from(body.rows);
      rows.sort(function (a, b) {
        const x = key(a), y = key(b);
        if (!numeric) return (down ? -1 : 1) * x.localeCompare(y, undefined, { numeric: true });
        if (x === "" || y === "") return (x === "") - (y === "");
        return down ? y - x : x - y;
      });
      rows.forEach(function (row) { body.appendChild(row); });
    };
  });

  // All pictures of a group show the same place, the one the pointer is at.
  document.querySelectorAll(".magnified").forEach(function (group) {
    group.addEventListener("pointermove", function (e) {
      const pane = e.target.closest(".pane");
      if (!pane) return;
      const box = pane.getBoundingClientRect();
      group.style.setProperty("--mx", 100 * (e.clientX - box.left) / box.width + "%");
      group.style.setProperty("--my", 100 * (e.clientY - box.top) / box.height + "%");
    });
  });

  const viewer = document.getElementById("viewer");
  const frame = viewer.querySelector("div");
  document.addEventListener("click", function (e) {
    const img = e.target;
    if (!img.matches || !img.matches(".pic:not(.slider) img")) return;
    const card = img.closest(".photo"), kind = img.dataset.kind;
    const compared = kind === "photo-pic" || kind === "render-pic";
    const shown = compared ? card.querySelector(".compare").cloneNode(true) : img.cloneNode();
    if (compared) {
      shown.style.setProperty("--x", "50%");
      shown.querySelector("input").value = 50;
    } else {
      shown.removeAttribute("loading");
    }
    shown.style.width = "min(100%, calc(88vh * " + (img.naturalWidth / img.naturalHeight || 1.5) + "))";
    frame.replaceChildren(shown);
    const what = compared ? "drag to compare photo and render" : img.alt.toLowerCase();
    viewer.querySelector("p").textContent = card ? card.querySelector("h3").textContent + " \u00b7 " + what : img.alt;
    viewer.showModal();
  });
  // Paper shows what is folded away.
  let unfolded = [];
  addEventListener("beforeprint", function () {
    unfolded = Array.from(document.querySelectorAll("details:not([open])"));
    unfolded.forEach(function (details) { details.open = true; });
  });
  addEventListener("afterprint", function () { unfolded.forEach(function (details) { details.open = false; }); });

  viewer.querySelector("button").onclick = function () { viewer.close(); };
  viewer.onclick = function (e) { if (e.target === viewer) viewer.close(); };
})();
