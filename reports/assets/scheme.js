"use strict";
(() => {
  // light, dark, or as the system has it; kept where the browser keeps anything
  const KEY = "footprint-scheme";
  const names = ["auto", "dark", "light"];
  const kept = () => {
    try {
      return localStorage.getItem(KEY);
    } catch {
      return null;
    }
  };
  const button = document.createElement("button");
  button.type = "button";
  button.className = "tool";
  const use = (name) => {
    if (name === "auto") delete document.documentElement.dataset.scheme;
    else document.documentElement.dataset.scheme = name;
    button.textContent = { auto: "◐ Auto", dark: "● Dark", light: "○ Light" }[name];
    button.setAttribute("aria-label", "Colours: " + name + ". Change");
    button.dataset.name = name;
  };
  button.addEventListener("click", () => {
    const next = names[(names.indexOf(button.dataset.name) + 1) % names.length];
    use(next);
    try {
      localStorage.setItem(KEY, next);
    } catch { /* for this time only */ }
  });
  use(names.includes(kept()) ? kept() : "auto");
  document.querySelector(".controls").append(button);
})();
