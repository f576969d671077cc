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

/** What is said at a command line, and what of the page it means. */
const OPTIONS = [
  [/give --corners/g, 'put the corners there by hand'], [/tell by --corners where the border is/g, 'put the corners on the border by hand'],
  [/check --arena/g, 'check its size'], [/add --arena.*/, 'say how wide and high it is'], [/a smaller --radius or --margin/, 'a smaller robot or margin'],
  [/--planner exact/g, 'the exact planner'], [/--([a-z-]+)/g, (_, name) => name.replaceAll('-', ' ')],
];

/** A text of the program as a sentence on the page. */
export function sentence(text) {
  const trimmed = OPTIONS.reduce((words, [option, here]) => words.replace(option, here), String(text).trim());
  return trimmed.charAt(0).toUpperCase() + trimmed.slice(1) + (/[.!?]$/.test(trimmed) ? '' : '.');
}

/** Name, value and unit of each figure, as tiles. */
export function figures(node, rows) {
  node.replaceChildren(...rows.map(([name, value, unit]) =>
    element('div', {}, element('dt', {}, name), element('dd', {}, value, unit ? element('small', {}, ` ${unit}`) : null))));
}
