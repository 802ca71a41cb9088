// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// That manifests.mjs finds what it is there for: one fault at a time is put into a copy of the files.
import assert from "node:assert";
import { spawnSync } from "node:child_process";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { test } from "node:test";
import yaml from "js-yaml";
import { rendered, selectorOf } from "./cells.mjs";
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

const CELL = "deploy/kubernetes/cell/daemon.yaml", TEMPLATE = "deploy/kubernetes/cell/kustomization.yaml", SIDE = "deploy/kubernetes/aggregation";
for (const [what, file, from, to, told] of [
  ["a misspelt property", CELL, "readOnlyRootFilesystem: true", "readOnlyRootFilesytem: true", "readOnlyRootFilesytem"],
  ["a misspelt property in a list of maps", CELL, "containerPort: 8080", "containerPorts: 8080", "containerPort"],
  ["a value of the wrong type", CELL, "replicas: 1", "replicas: one", "replicas"],
  ["a kind that is not", CELL, "kind: Deployment", "kind: Deploymnt", "Deploymnt"],
  ["a missing selector", CELL, "  selector: { matchLabels: { app: calibrd } }\n", "", "selector"],
  ["a selector of nothing", CELL, "matchLabels: { app: calibrd }", "matchLabels: { app: other }", "app=other"],
  ["a right too many", CELL, "allowPrivilegeEscalation: false", "privileged: true", "privileged"],
  ["a volume that is not there", CELL, "{ name: run, mountPath: /run/calibrd }", "{ name: ran, mountPath: /run/calibrd }", "volume ran"],
  ["a probe of no port", CELL, "path: /livez, port: http", "path: /livez, port: web", "port web"],
  ["a configuration that is not made", CELL, "configMap: { name: calibrd }", "configMap: { name: other }", "other"],
  ["a path of the node in a restricted namespace", CELL, "persistentVolumeClaim: { claimName: calibrd }", "hostPath: { path: /srv }", "mounts a hostPath"],
  ["no seccomp profile in a restricted namespace", CELL, "        seccompProfile: { type: RuntimeDefault }\n", "", "seccompProfile"],
  ["a claim that is not made", CELL, "claimName: calibrd", "claimName: other", "claim other"],
  ["a namespace that nothing makes", TEMPLATE, "namespace: calibrd", "namespace: other", "namespace other"],
  ["a secret that is not made", `${SIDE}/collector.yaml`, "secretName: calibrd-collector", "secretName: other", "other"],
  ["a service that selects another cell's pods", TEMPLATE, "    includeSelectors: true\n", "", "Service calibrd-cell7 selects pods of another cell"],
  ["a label that is no cell's own", TEMPLATE, "calibrd.io/cell: cell7", "calibrd.io/cell: one", "Deployment calibrd-cell7 selects pods of another cell"],
  ["a service that selects nothing", CELL, "  selector: { app: calibrd }\n  ports", "  selector: { app: other }\n  ports", "selects no pod"],
  ["a pose that is hidden while a robot is away", CELL, "publishNotReadyAddresses: true", "publishNotReadyAddresses: false", "hides a daemon"],
  ["a secret in the environment", `${SIDE}/collector.yaml`, "CALIBRD_COLLECTOR_USERNAME, value: collector",
    "CALIBRD_COLLECTOR_USERNAME, valueFrom: { secretKeyRef: { name: calibrd-postgres, key: password } }", "secret in its environment"],
  ["a secret of two cells", CELL, "secretName: calibrd-cell7", "secretName: calibrd-cell", "two cells have one secret"],
  ["a folder of two cells", "deploy/kubernetes/cell/volume.yaml", "/srv/calibrd/cell7", "/srv/calibrd", "two cells have one folder"],
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

const kubectl = spawnSync("kubectl", ["kustomize", join(source, "deploy/kubernetes/cell")], { encoding: "utf-8" });
test("cells are rendered as kustomize does", { skip: kubectl.status !== 0 && "no kubectl here" }, () => {
  const load = (file) => yaml.loadAll(readFileSync(join(source, "deploy/kubernetes/cell", file), "utf-8"));
  const [kustomization] = load("kustomization.yaml");
  const told = (object) => ({ kind: object.kind, name: object.metadata.name, namespace: object.metadata.namespace,
    selector: selectorOf(object), pods: object.spec?.template?.metadata.labels });
  const sorted = (objects) => objects.map(told).sort((a, b) => a.kind.localeCompare(b.kind));
  const made = yaml.loadAll(kubectl.stdout).filter((object) => object.kind !== "ConfigMap");
  assert.deepEqual(sorted(rendered(kustomization, kustomization.resources.flatMap(load))), sorted(made));
});

test("nothing is wrong with the files as they are", () => assert.deepEqual(faultsOf(source), []));
