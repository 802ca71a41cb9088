// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import type { Client } from "../api/client";
import type { Connection } from "../live/connection";
import type { CellState } from "../live/state";
import { h } from "../ui/dom";

/** Asks for a token while the daemon wants one. */
export function followTokens(client: Client, state: CellState, connection: Connection): void {
  const reason = h("p", { class: "error", role: "alert" });
  const field = h("input", { type: "password", id: "token", autocomplete: "off", required: true, "data-test": "token" });
  const enter = (event: Event): void => {
    event.preventDefault();
    client.token = field.value.trim();
    field.value = "";
    connection.retry();
  };
  const dialog = h(
    "dialog",
    { "aria-labelledby": "token-title" },
    h(
      "form",
      { submit: enter },
      h("h2", { id: "token-title" }, "This cell asks for a token"),
      h("p", {}, "Whoever runs the daemon makes one with: calibrd token create NAME --scope read"),
      h("label", { class: "field", for: "token" }, "Token", field),
      h("p", { class: "hint" }, "It is kept until this tab is closed."),
      reason,
      h("div", { class: "buttons" }, h("button", { class: "primary", type: "submit" }, "Enter")),
    ),
  );
  dialog.addEventListener("cancel", (event) => event.preventDefault()); // there is nothing to see behind it
  document.body.append(dialog);
  state.connection.follow((connectionState) => {
    const isWanted = connectionState.kind === "token";
    if (isWanted) reason.textContent = connectionState.reason;
    if (isWanted && !dialog.open) dialog.showModal();
    if (!isWanted && dialog.open && connectionState.kind === "live") dialog.close();
  });
}
