"use strict";
(() => {
  // one page at a time, the one that the address names
  const sections = [...document.querySelectorAll("main > section")];
  const links = [...document.querySelectorAll("header nav a")];
  const menus = [...document.querySelectorAll(".menu")];
  const title = document.title;
  const shut = (but) => menus.forEach((menu) => { if (menu !== but) menu.open = false; });
  const open = (element) => {
    for (let fold = element.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
  };
  const show = (event) => {
    const wanted = decodeURIComponent(location.hash.slice(1));
    const target = wanted && document.getElementById(wanted);
    if (wanted === "main") return document.getElementById("main").focus();
    const page = (target && target.closest("section")) || sections[0];
    for (const section of sections) section.classList.toggle("shown", section === page);
    const up = page.querySelector(":scope > .up a"); // what lists a page stands for it in the navigation
    for (const link of links) {
      if (link.hash === "#" + page.id) link.setAttribute("aria-current", "page");
      else link.removeAttribute("aria-current");
    }
    for (const menu of menus) {
      const here = [...menu.querySelectorAll("a")].some((link) => link.ariaCurrent || (up && link.hash === up.hash));
      menu.classList.toggle("here", here);
    }
    const head = page.querySelector("h1");
    if (head) document.title = head.textContent + " – " + title;
    shut();
    dispatchEvent(new CustomEvent("page", { detail: page }));
    if (target && target !== page) {
      open(target);
      target.scrollIntoView();
    } else window.scrollTo(0, 0);
    if (event && head) {
      const heading = target && target !== page ? target : head; // a screen reader goes on from here
      heading.tabIndex = -1;
      heading.focus({ preventScroll: true });
    }
  };
  // to any element, the address naming its page
  window.goTo = (element) => {
    const page = "#" + element.closest("section").id;
    if (decodeURIComponent(location.hash) !== page) history.pushState(null, "", page);
    show();
    open(element);
    element.scrollIntoView({ block: "center" });
    element.classList.remove("flash");
    void element.offsetWidth;
    element.classList.add("flash");
    element.tabIndex = -1;
    element.focus({ preventScroll: true });
  };
  document.body.classList.add("paged");
  addEventListener("hashchange", show);
  addEventListener("popstate", () => show());
  addEventListener("DOMContentLoaded", () => show());
  for (const menu of menus) menu.addEventListener("toggle", () => { if (menu.open) shut(menu); });
  addEventListener("click", (event) => { if (!event.target.closest(".menu")) shut(); });
  addEventListener("keydown", (event) => {
    const menu = event.key === "Escape" && menus.find((each) => each.open);
    if (menu) {
      shut();
      menu.querySelector("summary").focus();
    }
  });

  // contents stand open where there is room beside the page, and follow it
  const roomy = matchMedia("(min-width: 1500px)");
  const room = () => document.querySelectorAll(".contents details").forEach((each) => { each.open = roomy.matches; });
  roomy.addEventListener("change", room);
  room();
  let waiting = false;
  addEventListener("scroll", () => {
    up.hidden = scrollY < innerHeight;
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      const entries = [...document.querySelectorAll(".shown .contents a")];
      const above = entries.filter((link) => {
        const heading = document.getElementById(decodeURIComponent(link.hash.slice(1)));
        return heading && heading.getBoundingClientRect().top < 120;
      });
      for (const link of entries) link.removeAttribute("aria-current");
      if (above.length) above.at(-1).setAttribute("aria-current", "location");
    });
  }, { passive: true });

  const button = (text, act) => {
    const made = document.createElement("button");
    made.type = "button";
    made.className = "tool";
    made.textContent = text;
    made.addEventListener("click", act);
    return made;
  };
  const up = button("↑ Top", () => {
    window.scrollTo(0, 0);
    document.querySelector("header a").focus({ preventScroll: true });
  });
  up.classList.add("top");
  up.setAttribute("aria-label", "Back to the top of the page");
  up.hidden = true;
  document.body.append(up);
  const printing = (alone) => () => {
    document.body.classList.toggle("alone", alone);
    print();
  };
  addEventListener("afterprint", () => document.body.classList.remove("alone"));
  document.querySelector("footer").append(button("Print all pages", printing(false)), " ",
    button("Print this page", printing(true)));
})();
