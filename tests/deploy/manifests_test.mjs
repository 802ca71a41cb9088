// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// That manifests.mjs finds what it is there for: one fault at a time is put into a copy of the files.
import assert from "node:assert";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { test } from "node:test";
import { faultsOf } from "./manifests.mjs";

const source = resolve(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "../..");

/** The faults that are found when `from` in `file` is `to`. */
function faultsWith(file, from, to) {
  const root = mkdtempSync(join(tmpdir(), "calibrd-manifests-"));
  try {
    for (const folder of ["deploy/kubernetes", "docker"]) cpSync(join(source, folder), join(root, folder), { recursive: true });
    const text = readFileSync(join(root, file), "utf-8");
    assert(text.includes(from), `${file} has no ${from}`);
    writeFileSync(join(root, file), text.replace(from, to));
    return faultsOf(root);
  } finally {
    rmSync(root, { recursive: true });
  }
}

const CELL = "deploy/kubernetes/cell/daemon.yaml", SIDE = "deploy/kubernetes/aggregation";
for (const [what, file, from, to, told] of [
  ["a misspelt property", CELL, "readOnlyRootFilesystem: true", "readOnlyRootFilesytem: true", "readOnlyRootFilesytem"],
  ["a misspelt property in a list of maps", CELL, "containerPort: 8080", "containerPorts: 8080", "containerPort"],
  ["a value of the wrong type", CELL, "replicas: 1", "replicas: one", "replicas"],
  ["a kind that is not", CELL, "kind: Deployment", "kind: Deploymnt", "Deploymnt"],
  ["a missing selector", CELL, "  selector: { matchLabels: { app: calibrd } }\n", "", "selector"],
  ["a selector of nothing", CELL, "matchLabels: { app: calibrd }", "matchLabels: { app: other }", "app=other"],
  ["a right too many", CELL, "allowPrivilegeEscalation: false", "privileged: true", "privileged"],
  ["a volume that is not there", CELL, "{ name: data, mountPath: /data }", "{ name: dat, mountPath: /data }", "volume dat"],
  ["a probe of no port", CELL, "path: /livez, port: http", "path: /livez, port: web", "port web"],
  ["a configuration that is not made", CELL, "configMap: { name: calibrd }", "configMap: { name: other }", "other"],
  ["a secret that is not made", `${SIDE}/collector.yaml`, "secretName: calibrd-collector", "secretName: other", "other"],
  ["a resource that is not there", `${SIDE}/kustomization.yaml`, "broker.yaml,", "brokers.yaml,", "brokers.yaml"],
  ["an image without a version", `${SIDE}/broker.yaml`, "eclipse-mosquitto:2.0", "eclipse-mosquitto", "eclipse-mosquitto"],
  ["an image without a version that begins a pod", CELL, "      containers:", "        - { name: other, image: busybox }\n      containers:", "busybox"],
  ["a service with rights", "docker/compose.cell.yaml", "read_only: true", "privileged: true", "privileged"],
  ["a key that compose does not have", "docker/compose.cell.yaml", "stop_grace_period", "stop_grace_time", "stop_grace_time"],
])
  test(what, () => {
    const faults = faultsWith(file, from, to);
    assert(faults.some((fault) => fault.includes(told)), `found: ${faults.join("; ") || "nothing"}`);
  });

test("nothing is wrong with the files as they are", () => assert.deepEqual(faultsOf(source), []));
