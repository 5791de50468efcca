// Tables whose rows the reader puts in order by a column, and of which only the tests stay that have the words asked for.
const order = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" });

// By the number that a cell carries, or else by what it says; a dash is nothing and comes last in either direction.
function keyOf(cell) {
  const by = cell.querySelector("[data-by]");
  if (by) return Number(by.dataset.by);
  const text = cell.textContent.trim();
  return text === "–" || text === "" ? null : text;
}

function compare(one, other) {
  if (typeof one === "number" && typeof other === "number") return one - other;
  return order.compare(String(one), String(other));
}

function sortBy(table, head, column) {
  const down = head.getAttribute("aria-sort") === "ascending";
  for (const other of head.parentElement.children) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
  const body = table.tBodies[0];
  const rows = [...body.rows].map((row) => [keyOf(row.cells[column]), row]);
  const known = rows.filter(([key]) => key !== null), none = rows.filter(([key]) => key === null);
  known.sort(([one], [other]) => (down ? compare(other, one) : compare(one, other)));
  const inOrder = document.createDocumentFragment();
  for (const [, row] of [...known, ...none]) inOrder.append(row);
  body.append(inOrder);
}

function startSorting(table) {
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "sort";
    button.append(...head.childNodes);
    button.addEventListener("click", () => sortBy(table, head, column));
    head.append(button);
  });
}

// The first table has the tests; what is left out there is left out in all.
function startFilter(tables) {
  const input = document.querySelector(".filter input"), count = document.querySelector(".filter output");
  if (!input || !tables.length) return;
  const nameOf = (row) => row.cells[0].textContent.trim();
  const rows = tables.map((table) => [...table.tBodies[0].rows]);
  const texts = new Map(rows[0].map((row) => [nameOf(row), row.textContent.toLowerCase()]));
  input.addEventListener("input", () => {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    const left = new Set([...texts].filter(([, text]) => words.every((word) => text.includes(word))).map(([name]) => name));
    for (const row of rows.flat()) row.hidden = !left.has(nameOf(row));
    count.textContent = words.length ? `${left.size} of ${texts.size}` : "";
  });
}

function startTables() {
  const tables = [...document.querySelectorAll("table.sorts")];
  tables.forEach(startSorting);
  startFilter(tables);
}
