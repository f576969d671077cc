// Elements by name, made and filled.

export const find = (id) => document.getElementById(id);

/** An HTML element with attributes and children. */
export function element(name, attributes = {}, ...children) {
  return filled(document.createElement(name), attributes, children);
}

/** An SVG element. */
export function shape(name, attributes = {}, ...children) {
  return filled(document.createElementNS('http://www.w3.org/2000/svg', name), attributes, children);
}

function filled(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined && value !== null && value !== false) node.setAttribute(name, value === true ? '' : value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/** Puts a value into a field, unless somebody is typing there. */
export function fill(field, value) {
  if (document.activeElement !== field && field.value !== value) field.value = value;
}

/** Shows an error as { message, help }, or nothing. */
export function showProblem(node, problem, ...more) {
  node.hidden = !problem;
  if (!problem) return;
  const help = problem.help ? element('p', {}, sentence(problem.help)) : null;
  node.replaceChildren(element('p', {}, sentence(problem.message)), ...more, ...(help ? [help] : []));
}

export function sentence(text) {
  const trimmed = String(text).trim();
  return trimmed.charAt(0).toUpperCase() + trimmed.slice(1) + (/[.!?]$/.test(trimmed) ? '' : '.');
}

/** Name, value and unit of each figure, as tiles. */
export function figures(node, rows) {
  node.replaceChildren(...rows.map(([name, value, unit]) =>
    element('div', {}, element('dt', {}, name), element('dd', {}, value, unit ? element('small', {}, ` ${unit}`) : null))));
}
