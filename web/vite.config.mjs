// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
import { readFile, readdir, writeFile } from "node:fs/promises";
import { join, resolve } from "node:path";
import { gzipSync } from "node:zlib";
import { defineConfig } from "vite";

/** Beside every file that is worth it the same one compressed, for the daemon, which compresses nothing itself. */
function precompress(folder) {
  return {
    name: "precompress",
    async closeBundle() {
      for (const entry of await readdir(folder, { recursive: true, withFileTypes: true })) {
        if (!entry.isFile() || !/\.(js|css|html|svg)$/.test(entry.name)) continue;
        const file = join(entry.parentPath ?? entry.path, entry.name);
        await writeFile(`${file}.gz`, gzipSync(await readFile(file), { level: 9 }));
      }
    },
  };
}

/** What the page was built from, as make writes it, so that the build notices every change and no list is kept. */
function depfile(file, target) {
  return {
    name: "depfile",
    async closeBundle() {
      const sources = [...this.getModuleIds()]
        .map((id) => id.replace(/\?.*$/, ""))
        .filter((id) => id.startsWith("/") && !id.includes("node_modules"));
      const escaped = [...new Set(sources)].map((id) => id.replaceAll(" ", "\\ "));
      await writeFile(file, `${target}: ${escaped.join(" ")}\n`);
    },
  };
}

/** The notices of others' code that the page is bundled with: their licences ask to go with it. */
function notices() {
  return {
    name: "notices",
    async generateBundle() {
      const packages = new Set([...this.getModuleIds()].map((id) => id.match(/.*\/node_modules\/(@[^/]+\/)?[^/]+/)?.[0]).filter(Boolean));
      const texts = await Promise.all([...packages].sort().map(notice));
      this.emitFile({ type: "asset", fileName: "notices.txt", source: texts.join(`\n${"-".repeat(79)}\n\n`) });
    },
  };
}

async function notice(path) {
  const { name, version, license } = JSON.parse(await readFile(join(path, "package.json"), "utf-8"));
  const file = (await readdir(path)).find((entry) => /^licen[sc]e/i.test(entry));
  const text = file ? await readFile(join(path, file), "utf-8") : `Licence: ${license}; its package brings no text of it.\n`;
  return `${name} ${version} (${license})\n\n${text}`;
}

const folder = resolve(process.env.CALIBRD_WEB_OUT ?? "dist");
const { CALIBRD_WEB_DEPFILE: dependencies, CALIBRD_WEB_TARGET: target } = process.env;

export default defineConfig({
  base: "./",
  build: {
    outDir: folder,
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0, // the content security policy allows no data: script or style
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1000,
  },
  plugins: [notices(), precompress(folder), ...(dependencies ? [depfile(dependencies, target)] : [])],
});
