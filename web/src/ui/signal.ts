// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0

/** A value whose changes others follow. */
export class Signal<T> {
  private readonly listeners = new Set<(value: T) => void>();

  constructor(private current: T) {}

  get value(): T {
    return this.current;
  }

  set value(value: T) {
    this.current = value;
    for (const listener of this.listeners)
      try {
        listener(value);
      } catch (failure) {
        reportError(failure); // a fault of one panel must not leave the others with what is old
      }
  }

  /** Calls `listener` now and with every value to come. Returns how to stop it. */
  follow(listener: (value: T) => void): () => void {
    this.listeners.add(listener);
    listener(this.current);
    return () => this.listeners.delete(listener);
  }
}
