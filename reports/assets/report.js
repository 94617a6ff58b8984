"use strict";
(() => {
  // one page at a time, the one that the address names
  const sections = [...document.querySelectorAll("main > section")];
  const links = [...document.querySelectorAll("nav a")];
  const show = () => {
    const wanted = decodeURIComponent(location.hash.slice(1));
    const target = wanted && document.getElementById(wanted);
    const page = (target && target.closest("section")) || sections[0];
    for (const section of sections) section.classList.toggle("shown", section === page);
    for (const link of links) {
      if (link.hash === "#" + page.id) link.setAttribute("aria-current", "page");
      else link.removeAttribute("aria-current");
    }
    if (target && target !== page) target.scrollIntoView();
    else window.scrollTo(0, 0);
  };
  document.body.classList.add("paged");
  addEventListener("hashchange", show);
  show();

  // a click on the head of a column sorts by it, a second one the other way round; what is no number goes last
  const number = (text) => {
    const found = text.replace(/^<\s*/, "").match(/^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?/);
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
  for (const table of document.querySelectorAll("table")) {
    [...table.tHead.rows[0].cells].forEach((head, column) => {
      const button = document.createElement("button");
      button.append(...head.childNodes);
      head.append(button);
      button.addEventListener("click", () => sort(table, column, head));
    });
  }
})();
