// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { h } from "./dom";

export interface Question {
  title: string;
  text: string;
  /** What the button that goes on says. */
  action: string;
  /** It takes something away: the button says so by its colour too. */
  isDestructive?: boolean;
  /** Further fields, shown between text and buttons. */
  fields?: HTMLElement[];
}

/** True: whoever was asked wants it. Esc and "Cancel" do not. */
export function ask(question: Question): Promise<boolean> {
  return new Promise((resolve) => {
    const go = h("button", { class: question.isDestructive ? "danger" : "primary", value: "go", type: "submit" }, question.action);
    const dialog: HTMLDialogElement = h(
      "dialog",
      { "aria-labelledby": "question-title" },
      h(
        "form",
        { method: "dialog" },
        h("h2", { id: "question-title" }, question.title),
        h("p", {}, question.text),
        ...(question.fields ?? []),
        h("div", { class: "buttons" }, h("button", { value: "stay", type: "button", click: () => dialog.close("stay") }, "Cancel"), go),
      ),
    );
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === "go");
    });
    document.body.append(dialog);
    dialog.showModal();
    if (!question.isDestructive) go.focus();
  });
}

const MOST_ERRORS = 4;

/** Says what has happened, for people and screen readers. */
export class Notices {
  readonly element = h("div", { class: "notices", role: "status", "aria-live": "polite", "data-test": "notices" });

  /** What is said already is not said twice; of errors the newest stay until they are dismissed. */
  tell(text: string, isError = false): void {
    for (const said of [...this.element.children]) if (said.firstElementChild?.textContent === text) said.remove();
    const notice = h(
      "div",
      { class: isError ? "notice error" : "notice" },
      h("span", {}, text),
      h("button", { "aria-label": "Dismiss", click: () => notice.remove() }, "×"),
    );
    this.element.append(notice);
    const errors = [...this.element.querySelectorAll(".error")];
    for (const old of errors.slice(0, Math.max(0, errors.length - MOST_ERRORS))) old.remove();
    if (!isError) setTimeout(() => notice.remove(), 8000);
  }
}
