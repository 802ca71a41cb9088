// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0

/** An RFC 9457 problem of the daemon, or that it could not be reached (status 0). */
export class ApiProblem extends Error {
  constructor(
    readonly status: number,
    readonly code: string,
    message: string,
    readonly remedy = "",
  ) {
    super(message);
  }
}

const kToken = "calibrd.token";

/** Speaks to the daemon that serves the page, with the token that was entered, if any. */
export class Client {
  /** Called when the daemon wants a token, or another one. */
  onTokenWanted: (problem: ApiProblem) => void = () => undefined;

  get token(): string {
    return sessionStorage.getItem(kToken) ?? "";
  }

  /** Kept until the tab is closed, and not longer: see docs/page.md. */
  set token(token: string) {
    if (token) sessionStorage.setItem(kToken, token);
    else sessionStorage.removeItem(kToken);
  }

  /** Throws ApiProblem for every answer that is not of the 200s. */
  async fetch(path: string, init: RequestInit = {}): Promise<Response> {
    const headers = new Headers(init.headers);
    if (this.token) headers.set("Authorization", `Bearer ${this.token}`);
    let response: Response;
    try {
      response = await fetch(path, { ...init, headers });
    } catch (failure) {
      if (init.signal?.aborted) throw failure;
      throw new ApiProblem(0, "not_reached", "The daemon does not answer.");
    }
    if (response.ok) return response;
    const problem = await problemOf(response);
    if (problem.status === 401) this.onTokenWanted(problem);
    throw problem;
  }

  async get<T>(path: string, signal?: AbortSignal): Promise<T> {
    const response = await this.fetch(path, signal ? { signal } : {});
    return (await response.json()) as T;
  }

  async send<T>(method: "POST" | "DELETE", path: string, body?: unknown): Promise<T> {
    const init: RequestInit = { method };
    if (body !== undefined) {
      init.body = JSON.stringify(body);
      init.headers = { "Content-Type": "application/json" };
    }
    const response = await this.fetch(path, init);
    return (await response.json()) as T;
  }

  /** Saves what the daemon answers as a file, under the name the daemon gives it. */
  async download(path: string, init: RequestInit = {}): Promise<string> {
    const response = await this.fetch(path, init);
    const named = /filename="([^"]+)"/.exec(response.headers.get("Content-Disposition") ?? "");
    const name = named?.[1] ?? "calibrd.tar";
    const url = URL.createObjectURL(await response.blob());
    const link = document.createElement("a");
    link.href = url;
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
    return name;
  }
}

async function problemOf(response: Response): Promise<ApiProblem> {
  try {
    const body = (await response.json()) as Partial<Record<"code" | "title" | "detail" | "remedy", string>>;
    const message = [body.title, body.detail].filter(Boolean).join(" ");
    return new ApiProblem(response.status, body.code ?? "unknown", message, body.remedy);
  } catch {
    return new ApiProblem(response.status, "unknown", `The daemon answers ${response.status}.`);
  }
}

/** What went wrong, in words and with what to do. */
export function explain(failure: unknown): string {
  if (failure instanceof ApiProblem) return [failure.message, failure.remedy].filter(Boolean).join(" ");
  return failure instanceof Error ? failure.message : String(failure);
}

/** Reports what is a mistake of the page, not an answer of the daemon, a broken connection (TypeError) or an end that the page wanted. */
export function reportFault(failure: unknown): void {
  const isExpected = failure instanceof ApiProblem || failure instanceof TypeError || failure instanceof DOMException;
  if (!isExpected) reportError(failure);
}
