// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0

/** `action`, never twice at once: asked for while it goes on, it is done once more afterwards, so that the last answer is never of an
 * earlier question. What is returned ends when all that was asked for is done. */
export function oneAtATime(action: () => Promise<void>): () => Promise<void> {
  let running: Promise<void> | null = null;
  let isWanted = false;
  const run = async (): Promise<void> => {
    try {
      while (isWanted) {
        isWanted = false;
        await action();
      }
    } finally {
      running = null;
    }
  };
  return () => {
    isWanted = true;
    return (running ??= run());
  };
}
