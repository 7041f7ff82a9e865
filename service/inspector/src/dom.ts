/** An element of index.html by its id. */
export const get = <E extends HTMLElement>(id: string): E => document.getElementById(id) as E;

/** A span of a class with text in it. */
export function span(name: string, text: string): HTMLSpanElement {
  const element = document.createElement('span');
  element.className = name;
  element.textContent = text;
  return element;
}
