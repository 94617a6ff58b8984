"use strict";
(() => {
  const tables = [...document.querySelectorAll("main table:has(tbody)")];

  // a click on the head of a column sorts by it, a second one the other way round; what is no number goes last
  const number = (text) => {
    const found = text.replace(/^[<>≤≥]\s*/, "").match(/^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?/);
    return found ? Number(found[0]) : /^inf/.test(text) ? Infinity : NaN;
  };
  const sort = (table, column, head) => {
    const body = table.tBodies[0];
    const rows = [...body.rows].map((row) => ({ row, text: row.cells[column].textContent.trim() }));
    const sign = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    const numeric = head.classList.contains("n");
    const compare = (a, b) => {
      if (!numeric) return sign * (a.text < b.text ? -1 : a.text > b.text ? 1 : 0);
      const [x, y] = [number(a.text), number(b.text)];
      if (Number.isNaN(x) || Number.isNaN(y)) return Number.isNaN(x) - Number.isNaN(y);
      return x === y ? 0 : sign * (x < y ? -1 : 1);
    };
    body.append(...rows.sort(compare).map(({ row }) => row));
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", sign === 1 ? "ascending" : "descending");
  };

  // rows that have all the words stay; what stays can be taken away as CSV
  const ROWS = 10;
  const made = (name, properties) => Object.assign(document.createElement(name), properties);
  const told = (table) => (table.caption ? table.caption.textContent : "table");
  const csv = (table) => [...table.rows].filter((row) => !row.hidden).map((row) =>
    [...row.cells].map((cell) => '"' + cell.textContent.replaceAll('"', '""') + '"').join(",")).join("\n") + "\n";
  const save = (table) => {
    const link = made("a", { download: told(table).replace(/[^\w]+/g, "-").slice(0, 60) + ".csv" });
    link.href = URL.createObjectURL(new Blob([csv(table)], { type: "text/csv" }));
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const tools = (table) => {
    const rows = [...table.tBodies[0].rows];
    const field = made("input", { type: "search", placeholder: "Filter rows", ariaLabel: "Filter rows: " + told(table) });
    const count = made("span", { role: "status", textContent: rows.length + " rows" });
    field.addEventListener("input", () => {
      const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
      let left = 0;
      for (const row of rows) {
        const text = row.textContent.toLowerCase();
        row.hidden = !words.every((word) => text.includes(word));
        left += !row.hidden;
      }
      count.textContent = words.length ? left + " of " + rows.length + " rows" : rows.length + " rows";
    });
    const button = made("button", { type: "button", className: "tool", textContent: "Save as CSV" });
    button.setAttribute("aria-label", "Save as CSV: " + told(table));
    button.addEventListener("click", () => save(table));
    const bar = made("div", { className: "tools" });
    bar.append(field, count, button);
    table.parentElement.before(bar);
  };

  // a table wider than the page scrolls by itself, under a hint, and keeps its head and its first column
  const FROZEN = 0.4; // of the width at the most
  const fit = (wide) => {
    if (!wide.offsetWidth) return;
    wide.classList.remove("fits", "scrolls", "freeze");
    const table = wide.querySelector("table");
    const scrolls = table.offsetWidth > wide.clientWidth + 1;
    wide.classList.add(scrolls ? "scrolls" : "fits");
    const first = table.rows[0].cells[0].offsetWidth;
    wide.classList.toggle("freeze", scrolls && first < FROZEN * wide.clientWidth);
    let hint = wide.previousElementSibling;
    if (scrolls && !(hint && hint.classList.contains("hint"))) {
      hint = made("p", { className: "hint", textContent: "↔ Wider than the page: scroll sideways, or with the arrow keys." });
      wide.before(hint);
    } else if (!scrolls && hint && hint.classList.contains("hint")) hint.remove();
    if (scrolls) {
      Object.assign(wide, { tabIndex: 0, role: "region", ariaLabel: told(table) });
    } else for (const name of ["tabindex", "role", "aria-label"]) wide.removeAttribute(name);
  };
  const fitAll = (within) => within.querySelectorAll(".wide").forEach(fit);
  const bar = () => {
    const height = document.querySelector("header").offsetHeight;
    document.documentElement.style.setProperty("--bar", height + "px");
    document.documentElement.style.scrollPaddingTop = height + 16 + "px";
  };

  for (const table of tables) {
    [...table.tHead.rows[0].cells].forEach((head, column) => {
      if (!head.textContent.trim()) return; // a button without a name is none
      const button = document.createElement("button");
      button.append(...head.childNodes);
      head.scope = "col";
      head.append(button);
      button.addEventListener("click", () => sort(table, column, head));
    });
    if (table.tBodies[0].rows.length >= ROWS) tools(table);
  }
  addEventListener("page", (event) => { bar(); fitAll(event.detail); });
  addEventListener("resize", () => { bar(); fitAll(document.querySelector(".shown") || document); });
  addEventListener("toggle", (event) => { if (event.target.closest("main")) fitAll(event.target); }, true);
})();
