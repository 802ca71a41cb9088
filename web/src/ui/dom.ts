// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0

type Child = Node | string | number | null | undefined | false;
type Attributes = Record<string, string | number | boolean | ((event: Event) => void) | undefined>;

/** An element with attributes and children. Functions become listeners; false and undefined are left out. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  setAttributes(element, attributes);
  append(element, children);
  return element;
}

/** The same for SVG. */
export function svg(tag: string, attributes: Attributes = {}, ...children: Child[]): SVGElement {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  setAttributes(element, attributes);
  append(element, children);
  return element;
}

function setAttributes(element: Element, attributes: Attributes): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== undefined && value !== false) element.setAttribute(name, String(value));
  }
}

function append(element: Element, children: Child[]): void {
  for (const child of children)
    if (child !== null && child !== undefined && child !== false) element.append(typeof child === "number" ? String(child) : child);
}

/** Puts `text` there without touching what already says so: selections and focus stay, and screen readers stay calm. */
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

/** Has `replace` draw rows (`data-id`) of `place` anew, and leaves the focus where it was: in the same row, on what has the same `data-test`. */
export function keepingFocus(place: Element, replace: () => void): void {
  const had = document.activeElement instanceof HTMLElement && place.contains(document.activeElement) ? document.activeElement : null;
  const { id } = had?.closest<HTMLElement>("[data-id]")?.dataset ?? {};
  replace();
  if (!had || id === undefined) return;
  const row = [...place.querySelectorAll<HTMLElement>("[data-id]")].find((one) => one.dataset["id"] === id);
  const same = [...(row?.querySelectorAll<HTMLElement>(had.tagName) ?? [])].find((one) => one.dataset["test"] === had.dataset["test"]);
  same?.focus({ preventScroll: true });
}

export function setAttribute(element: Element, name: string, value: string): void {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}
