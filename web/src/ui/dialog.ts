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
    const dialog = h(
      "dialog",
      { "aria-labelledby": "question-title" },
      h(
        "form",
        { method: "dialog" },
        h("h2", { id: "question-title" }, question.title),
        h("p", {}, question.text),
        ...(question.fields ?? []),
        h("div", { class: "buttons" }, h("button", { value: "stay", type: "submit" }, "Cancel"), go),
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

/** Says what has happened, for people and screen readers. */
export class Notices {
  readonly element = h("div", { class: "notices", role: "status", "aria-live": "polite" });

  tell(text: string, isError = false): void {
    const notice = h(
      "div",
      { class: isError ? "notice error" : "notice" },
      h("span", {}, text),
      h("button", { "aria-label": "Dismiss", click: () => notice.remove() }, "×"),
    );
    this.element.append(notice);
    if (!isError) setTimeout(() => notice.remove(), 8000);
  }
}
