"use strict";
(() => {
  // every word of every page; a result leads to the paragraph, the row or the figure
  const MOST = 60;
  const BLOCKS = "h1, h2, h3, p, li, caption, tbody tr, figcaption, pre";
  let index = null;
  const indexed = () => [...document.querySelectorAll("main > section")].flatMap((section) => {
    const page = (section.querySelector("h1") || section).textContent;
    let heading = "";
    return [...section.querySelectorAll(BLOCKS)].filter((block) => !block.closest(".contents, .hint")).map((block) => {
      const spaced = block.cells ? [...block.cells].map((cell) => cell.textContent).join(" | ") : block.textContent;
      if (/^H[123]$/.test(block.tagName)) heading = block.tagName === "H1" ? "" : spaced;
      return { block, page, heading, text: spaced, low: spaced.toLowerCase(), head: /^H/.test(block.tagName) };
    });
  });
  const made = (name, properties) => Object.assign(document.createElement(name), properties);
  const field = made("input", { type: "search", placeholder: "Search all pages ( / )", ariaLabel: "Search all pages" });
  const found = made("div", { className: "found", hidden: true, id: "found" });
  const count = made("p", { role: "status" });
  found.append(count);
  field.setAttribute("aria-controls", "found");
  field.setAttribute("aria-expanded", "false");
  field.setAttribute("role", "combobox");
  const controls = made("div", { className: "controls" });
  controls.setAttribute("role", "search");
  controls.append(field, found);
  document.querySelector("header").append(controls);

  const close = () => {
    found.hidden = true;
    field.setAttribute("aria-expanded", "false");
  };
  const snippet = (text, words) => {
    const at = Math.max(0, Math.min(...words.map((word) => text.toLowerCase().indexOf(word))) - 60);
    const part = (at ? "…" : "") + text.slice(at, at + 220) + (at + 220 < text.length ? "…" : "");
    const line = document.createElement("small");
    const escaped = words.map((word) => word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
    for (const piece of part.split(new RegExp("(" + escaped.join("|") + ")", "gi"))) {
      line.append(words.includes(piece.toLowerCase()) ? made("mark", { textContent: piece }) : piece);
    }
    return line;
  };
  const look = () => {
    const words = [...new Set(field.value.toLowerCase().split(/\s+/).filter(Boolean))];
    if (!words.length) return close();
    index = index || indexed();
    const hits = index.filter((each) => words.every((word) => each.low.includes(word)));
    hits.sort((a, b) => b.head - a.head);
    const shown = hits.slice(0, MOST).map(({ block, page, heading, text }) => {
      const link = made("a", { href: "#" + block.closest("section").id, textContent: page + (heading ? " › " + heading : "") });
      link.append(snippet(text, words));
      link.addEventListener("click", (event) => {
        event.preventDefault();
        close();
        window.goTo(block);
      });
      return link;
    });
    count.textContent = hits.length > MOST ? hits.length + " places, the first " + MOST : hits.length + " places";
    found.replaceChildren(count, ...shown);
    found.hidden = false;
    field.setAttribute("aria-expanded", "true");
  };
  let timer = 0;
  field.addEventListener("input", () => {
    clearTimeout(timer);
    timer = setTimeout(look, 120);
  });
  const move = (event) => {
    const links = [field, ...found.querySelectorAll("a")];
    const at = links.indexOf(document.activeElement) + (event.key === "ArrowDown" ? 1 : -1);
    event.preventDefault();
    links[Math.max(0, Math.min(at, links.length - 1))].focus();
  };
  controls.addEventListener("keydown", (event) => {
    if (event.key === "Escape") {
      close();
      field.focus();
    } else if (/^Arrow(Up|Down)$/.test(event.key) && !found.hidden) move(event);
    else if (event.key === "Enter" && document.activeElement === field) {
      look();
      const first = found.querySelector("a");
      if (first && !found.hidden) first.click();
    }
  });
  addEventListener("keydown", (event) => {
    if (event.key === "/" && !/^(INPUT|TEXTAREA)$/.test(document.activeElement.tagName)) {
      event.preventDefault();
      field.focus();
    }
  });
  addEventListener("page", close);
  addEventListener("click", (event) => { if (!event.target.closest(".controls")) close(); });
})();
