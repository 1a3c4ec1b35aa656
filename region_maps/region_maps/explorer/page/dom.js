// Elements of the page. All text goes in as text nodes, so that no name can become markup.

function byId(id) {
  return document.getElementById(id);
}

function element(tag, text = '', attributes = {}) {
  const made = document.createElement(tag);
  if (text !== '') made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

// Fills a select with [value, text] pairs.
function fillSelect(select, entries) {
  select.replaceChildren(...entries.map(([value, text]) => element('option', text, {value})));
}

function saveFile(name, blob) {
  const link = element('a', '', {download: name, href: URL.createObjectURL(blob)});
  link.click();
  URL.revokeObjectURL(link.href);
}
