// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Parts of the page for tests without a browser, bundled as the page is.
import { fileURLToPath } from "node:url";
import { build } from "vite";

const SRC = fileURLToPath(new URL("../../src/", import.meta.url));

/** All that the modules export ("view/splat"), as one; with what is taken from three.js beside it. */
export async function load(...modules) {
  const entry = "virtual:all";
  const lines = [...modules.map((module) => `export * from ${JSON.stringify(SRC + module)};`), 'export { Matrix4, PerspectiveCamera, Vector3 } from "three";'];
  const all = { name: "all", enforce: "pre", resolveId: (id) => (id.endsWith(entry) ? entry : null), load: (id) => (id === entry ? lines.join("\n") : null) };
  const [{ output }] = await build({
    configFile: false,
    root: fileURLToPath(new URL("../..", import.meta.url)),
    logLevel: "error",
    plugins: [all],
    build: { write: false, minify: false, target: "node18", lib: { entry, formats: ["es"], fileName: "all" } },
  });
  return import(`data:text/javascript;base64,${Buffer.from(output[0].code).toString("base64")}`);
}
