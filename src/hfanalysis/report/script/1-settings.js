// Units and theme: what the reader chose, kept for the next page where the browser allows it.
const root = document.documentElement;

function remembered(name) {
  try { return localStorage.getItem("hfanalysis-" + name); } catch { return null; }
}

function remember(name, value) {
  try { localStorage.setItem("hfanalysis-" + name, value); } catch { /* a page from a file may have no storage */ }
}

const settings = { units: "si", theme: "auto" };

// Every text that reads differently in the other units carries both; the numbers were formatted where the page was made.
function showUnits(units) {
  settings.units = units;
  root.dataset.units = units;
  for (const element of document.querySelectorAll("[data-team]")) element.textContent = element.dataset[units];
}

function showTheme(theme) {
  settings.theme = theme;
  if (theme === "auto") delete root.dataset.theme; else root.dataset.theme = theme;
}

function pressOne(group, value) {
  for (const button of group.querySelectorAll("button")) {
    button.setAttribute("aria-pressed", String(button.value === value));
  }
}

function offer(name, show, after) {
  const group = document.getElementById("choose-" + name);
  if (!group) return;
  const choose = (value) => {
    show(value);
    remember(name, value);
    pressOne(group, value);
    after();
  };
  group.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (button) choose(button.value);
  });
  const known = remembered(name);
  const offered = [...group.querySelectorAll("button")].map((button) => button.value);
  if (offered.includes(known)) { show(known); pressOne(group, known); }
}
