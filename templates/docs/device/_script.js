"use strict";
(() => {
  document.documentElement.classList.add("js");
  const input = document.getElementById("query");
  const list = document.getElementById("results");
  const status = document.getElementById("status");
  const fold = (text) => text.toLowerCase().replace(/[^a-z0-9]/g, "");
  const hex = (number, digits) => number.toString(16).toUpperCase().padStart(digits, "0") + "h";

  // What can be found: every element that carries data-kind. Its text is read when the first letter is typed.
  let index = null;
  const read = () => index || (index = [...document.querySelectorAll("[data-kind]")].map((element) => {
    const home = element.parentElement.closest("[data-label]");
    const label = element.dataset.label;
    return {
      element, label, kind: element.dataset.kind, home: home ? home.dataset.label : "",
      folded: fold(label), words: (element.dataset.words || "").toLowerCase().split(" ").map(fold),
      text: element.textContent.toLowerCase(), first: parseInt(element.dataset.index || "", 10),
      stride: parseInt(element.dataset.stride || "0", 10), length: parseInt(element.dataset.length || "1", 10),
    };
  }));

  // Object with this index on any axis: axis n of it is at first + n * stride, and takes `length` indices.
  const axes = parseInt(document.body.dataset.axes, 10);
  const axisOf = (item, number) => {
    for (let axis = 0; axis < (item.stride ? axes : 1); axis += 1) {
      const offset = number - item.first - axis * item.stride;
      if (offset >= 0 && offset < item.length) return axis;
    }
    return -1;
  };

  const search = (query) => {
    const typed = query.trim().toLowerCase();
    const digits = /^(?:0x)?([0-9a-f]{4})h?(?:[: .]?(?:sub)?([0-9a-f]{1,2})h?)?$/.exec(typed);
    const number = digits ? parseInt(digits[1], 16) : -1;
    const code = typed.replace(/^(?:emcy|abort|0x)\s*(?:0x)?/, "").replace(/h$/, "");
    const wanted = fold(typed);
    const terms = typed.split(/\s+/).filter(Boolean);
    const found = [];
    for (const item of read()) {
      let rank = 0;
      let detail = item.home;
      if (number >= 0 && !Number.isNaN(item.first)) {
        const axis = axisOf(item, number);
        if (axis >= 0) {
          rank = 100;
          detail = item.stride ? `${hex(number, 4)} is axis ${axis} (axes count from 0)` : "";
        }
      }
      if (!rank && item.words.includes(fold(code))) rank = 95;
      if (!rank && wanted && item.folded === wanted) rank = 90;
      if (!rank && wanted && item.words.includes(wanted)) rank = 85;
      if (!rank && wanted && item.folded.startsWith(wanted)) rank = 70;
      if (!rank && wanted && item.folded.includes(wanted)) rank = 60;
      if (!rank && wanted && item.words.some((word) => word.startsWith(wanted))) rank = 55;
      if (!rank && terms.every((term) => item.text.includes(term) || item.label.toLowerCase().includes(term))) rank = 20;
      if (rank) found.push({ item, detail, rank: rank + (item.element.dataset.kind === "Object" ? 1 : 0) });
    }
    return found.sort((a, b) => b.rank - a.rank);
  };

  let shown = [];
  let chosen = -1;
  const close = () => {
    list.hidden = true;
    input.setAttribute("aria-expanded", "false");
    input.removeAttribute("aria-activedescendant");
  };
  const choose = (position) => {
    chosen = position;
    [...list.querySelectorAll("[role=option]")].forEach((row, i) => {
      row.setAttribute("aria-selected", String(i === position));
      if (i === position) {
        input.setAttribute("aria-activedescendant", row.id);
        row.scrollIntoView({ block: "nearest" });
      }
    });
  };
  const go = (element) => {
    close();
    if (element.id) history.pushState(null, "", `#${element.id}`);
    element.scrollIntoView({ block: "start" });
    element.classList.remove("found");
    void element.offsetWidth; // lets the same element flash again
    element.classList.add("found");
    element.setAttribute("tabindex", "-1");
    element.focus({ preventScroll: true });
  };
  const span = (name, text) => {
    const element = document.createElement("span");
    element.className = name;
    element.textContent = text;
    return element;
  };
  const show = () => {
    const query = input.value;
    if (!query.trim()) {
      close();
      status.textContent = "";
      return;
    }
    const found = search(query);
    shown = found.slice(0, 40);
    status.textContent = found.length === 1 ? "1 result" : `${found.length} results`;
    list.replaceChildren(...shown.map(({ item, detail }, i) => {
      const row = document.createElement("li");
      row.id = `result-${i}`;
      row.setAttribute("role", "option");
      const what = span("what", item.label);
      if (detail) what.append(span("where", detail));
      row.append(what, span("kind", item.kind));
      row.addEventListener("mousedown", (event) => event.preventDefault());
      row.addEventListener("click", () => go(item.element));
      return row;
    }));
    if (!shown.length) {
      const none = document.createElement("li");
      none.className = "none";
      none.textContent = "Nothing found. Try an index, a name, a code or a word.";
      list.append(none);
    }
    list.hidden = false;
    input.setAttribute("aria-expanded", "true");
    choose(shown.length ? 0 : -1);
  };
  input.addEventListener("input", show);
  input.addEventListener("focus", show);
  input.addEventListener("blur", close);
  input.addEventListener("keydown", (event) => {
    if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      event.preventDefault();
      if (list.hidden) show();
      else if (shown.length) choose((chosen + (event.key === "ArrowDown" ? 1 : shown.length - 1)) % shown.length);
    } else if (event.key === "Enter" && !list.hidden && shown[chosen]) {
      event.preventDefault();
      go(shown[chosen].item.element);
    } else if (event.key === "Escape") {
      if (list.hidden) input.value = "";
      close();
    }
  });
  document.addEventListener("keydown", (event) => {
    const typing = /^(?:INPUT|TEXTAREA|SELECT)$/.test(event.target.tagName);
    if (event.key === "/" && !typing && !event.ctrlKey && !event.metaKey && !event.altKey) {
      event.preventDefault();
      input.focus();
      input.select();
    }
  });

  // A link to an index of another axis, #6840h, leads to the object.
  const follow = () => {
    const match = /^#(?:0x)?([0-9a-f]{4})h?$/i.exec(location.hash);
    if (!match || document.getElementById(location.hash.slice(1))) return;
    const hit = read().find((item) => !Number.isNaN(item.first) && axisOf(item, parseInt(match[1], 16)) >= 0);
    if (hit) hit.element.scrollIntoView();
  };
  addEventListener("hashchange", follow);
  follow();

  // On a phone the table of contents opens from a button.
  const menu = document.getElementById("menu");
  const contents = document.getElementById("contents");
  const toggle = (open) => {
    contents.classList.toggle("open", open);
    menu.setAttribute("aria-expanded", String(open));
  };
  menu.addEventListener("click", () => toggle(!contents.classList.contains("open")));
  contents.addEventListener("click", (event) => {
    if (event.target.closest("a")) toggle(false);
  });
})();
