// Sections that fold: what is linked to opens, paper shows everything.
function openLinked() {
  const section = location.hash.length > 1 ? document.getElementById(decodeURIComponent(location.hash.slice(1))) : null;
  const fold = section && section.querySelector(":scope > details.fold");
  if (fold) fold.open = true;
}

function startFolds() {
  const folds = [...document.querySelectorAll("details.fold")], button = document.getElementById("fold-all");
  if (!folds.length) return;
  const label = () => { button.textContent = folds.some((fold) => fold.open) ? "Fold all" : "Unfold all"; };
  for (const fold of folds) fold.addEventListener("toggle", () => { label(); schedule(); });
  button.addEventListener("click", () => {
    const open = !folds.some((fold) => fold.open);
    for (const fold of folds) fold.open = open;
  });
  // The link to where one already is changes no address, but may be to what was folded since.
  document.getElementById("contents").addEventListener("click", () => setTimeout(openLinked, 0));
  addEventListener("hashchange", openLinked);
  openLinked();
  label();
  const more = [...document.querySelectorAll("details.more, details.why")];
  for (const part of more) part.addEventListener("toggle", () => schedule());
  let closed = [];
  addEventListener("beforeprint", () => {
    closed = [...folds, ...more].filter((fold) => !fold.open);
    for (const fold of closed) fold.open = true;
  });
  addEventListener("afterprint", () => { for (const fold of closed) fold.open = false; });
}
