// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { h } from "./dom";

export interface Tab {
  id: string;
  title: string;
  panel: HTMLElement;
  /** Called when it becomes visible: charts take their size then. */
  onShow?: () => void;
}

/** Tabs as the ARIA Authoring Practices describe them: arrow keys move, one tab is in the tab order. */
export function tabs(label: string, all: Tab[]): HTMLElement {
  const buttons = all.map((tab) =>
    h("button", { role: "tab", id: `tab-${tab.id}`, "aria-controls": `panel-${tab.id}`, click: () => show(tab) }, tab.title),
  );
  const list = h("div", { role: "tablist", "aria-label": label, class: "tabs" }, ...buttons);
  for (const tab of all) {
    tab.panel.id = `panel-${tab.id}`;
    tab.panel.setAttribute("role", "tabpanel");
    tab.panel.setAttribute("aria-labelledby", `tab-${tab.id}`);
    tab.panel.tabIndex = 0;
  }
  const show = (shown: Tab): void => {
    all.forEach((tab, index) => {
      const isShown = tab === shown;
      tab.panel.hidden = !isShown;
      buttons[index]?.setAttribute("aria-selected", String(isShown));
      buttons[index]?.setAttribute("tabindex", isShown ? "0" : "-1");
    });
    shown.onShow?.();
  };
  list.addEventListener("keydown", (event) => {
    const at = buttons.indexOf(document.activeElement as HTMLButtonElement);
    const target = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: -1 }[event.key];
    if (at < 0 || target === undefined) return;
    event.preventDefault(); // Home and End would scroll
    const next = (target + all.length) % all.length;
    buttons[next]?.focus();
    buttons[next]?.click();
  });
  if (all[0]) show(all[0]);
  return h("div", { class: "tabbed" }, list, ...all.map((tab) => tab.panel));
}
