// What stands around an explorer on a page of its own: links to the others, and, for patterns, a
// csv to open (or to drop anywhere on the page) and one to download. The address of the page always
// names the setting that is shown.

function element(kind, properties, ...children) {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
}

function save({ name, text }) {
  const address = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60000); // the browser takes it in its own time
}

async function hand(model, file) {
  if (file) model.send({ kind: "opened", name: file.name, text: await file.text() });
}

function render({ model, el }) {
  const names = element("nav", { className: "arkaq-names", ariaLabel: "explorers" });
  for (const name of model.get("names")) {
    const link = element("a", { href: `?explorer=${name}`, textContent: name });
    if (name === model.get("name")) link.setAttribute("aria-current", "page");
    names.append(link);
  }
  el.replaceChildren(names);
  document.title = `${model.get("name")} · arkaq`;

  const tell = () => history.replaceState(null, "", `?${model.get("query")}`);
  model.on("change:query", tell);
  const stop = new AbortController();
  if (model.get("takes_patterns")) {
    const file = element("input", { type: "file", accept: ".csv,.txt,.tsv", hidden: true });
    file.addEventListener("change", () => hand(model, file.files[0]));
    const button = (words, title, act) =>
      element("button", { className: "jupyter-widgets jupyter-button", textContent: words, title, onclick: act });
    el.append(
      file,
      button("open a csv of patterns", "Or drop it anywhere on this page", () => file.click()),
      button("download the centers", "The centers of all categories, as a csv", () => model.send({ kind: "centers" })),
    );
    const on = (name, act) => document.addEventListener(name, act, { signal: stop.signal });
    on("dragover", (event) => event.preventDefault());
    on("drop", (event) => {
      event.preventDefault();
      hand(model, event.dataTransfer.files[0]);
    });
  }
  const receive = (message) => save(message);
  model.on("msg:custom", receive);
  return () => {
    stop.abort();
    model.off("change:query", tell);
    model.off("msg:custom", receive);
  };
}

export default { render };
