#!/usr/bin/env node
// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Kubernetes manifests and compose files: valid, whole, and asking for no more rights than they need.
// usage: manifests.mjs SOURCE
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import yaml from "js-yaml";
import { cellFaults } from "./cells.mjs";
import { podFaults } from "./pods.mjs";
import { composeFaults, kubernetesFaults } from "./schemas.mjs";

const source = process.argv[2];
const read = (path) => readFileSync(path, "utf-8");

/** The Pod Security level of each namespace that a folder makes. */
function levelsOf(folders) {
  const spaces = folders.flatMap((folder) => readdirSync(folder).filter((file) => file.endsWith(".yaml"))
    .flatMap((file) => yaml.loadAll(read(join(folder, file))))).filter((object) => object?.kind === "Namespace");
  return new Map(spaces.map(({ metadata }) => [metadata.name, metadata.labels?.["pod-security.kubernetes.io/enforce"] ?? "privileged"]));
}

/** One folder that `kubectl apply -k` takes. */
function kustomizationFaults(folder, levels) {
  const text = read(join(folder, "kustomization.yaml"));
  const kustomization = yaml.load(text);
  const files = [...kustomization.resources, ...(kustomization.configMapGenerator ?? []).flatMap((map) => map.files)];
  const faults = files.filter((file) => !existsSync(join(folder, file))).map((file) => `${folder} lacks ${file}`);
  const listed = new Set([...kustomization.resources, "kustomization.yaml"]);
  for (const file of readdirSync(folder))
    if (file.endsWith(".yaml") && !listed.has(file)) faults.push(`${folder}: nothing takes ${file}`);
  const objects = kustomization.resources.filter((file) => existsSync(join(folder, file)))
    .flatMap((file) => yaml.loadAll(read(join(folder, file))));
  if (!levels.has(kustomization.namespace)) faults.push(`${folder}: nothing makes the namespace ${kustomization.namespace}`);
  const known = {
    level: levels.get(kustomization.namespace),
    claim: objects.filter((object) => object.kind === "PersistentVolumeClaim").map((object) => object.metadata.name),
    configMap: (kustomization.configMapGenerator ?? []).map((map) => map.name),
    secret: [...text.matchAll(/create secret generic (\S+)/g)].map((match) => match[1]), // its head says how they are made
  };
  const images = new Set((kustomization.images ?? []).map((image) => image.name));
  for (const object of objects)
    for (const container of containersOf(object))
      if (!container.image.includes(":") && !images.has(container.image)) faults.push(`${container.image} has no version`);
  return [...faults, ...objects.flatMap((object) => [...kubernetesFaults(object), ...podFaults(object, known)])];
}

function containersOf(object) {
  const spec = object.spec?.template?.spec;
  return [...(spec?.initContainers ?? []), ...(spec?.containers ?? [])];
}

function serviceFaults(name, services) {
  return Object.entries(services).flatMap(([key, service]) => {
    const faults = [];
    if (service.privileged) faults.push("is privileged");
    if (service.read_only !== true) faults.push("may write its root file system");
    if (!service.cap_drop?.includes("ALL")) faults.push("keeps capabilities");
    if (!service.security_opt?.includes("no-new-privileges:true")) faults.push("may gain rights");
    return faults.map((fault) => `${name}: ${key} ${fault}`);
  });
}

export function faultsOf(root) {
  const kubernetes = join(root, "deploy/kubernetes"), docker = join(root, "docker");
  const compose = readdirSync(docker).filter((file) => file.startsWith("compose."));
  const folders = readdirSync(kubernetes).map((folder) => join(kubernetes, folder)), levels = levelsOf(folders);
  return [
    ...folders.flatMap((folder) => [...kustomizationFaults(folder, levels), ...cellFaults(folder)]),
    ...compose.flatMap((file) => {
      const document = yaml.load(read(join(docker, file)));
      return [...composeFaults(file, document), ...serviceFaults(file, document.services)];
    }),
  ];
}

if (source) {
  const faults = faultsOf(source);
  for (const fault of faults) console.error(fault);
  process.exit(faults.length ? 1 : 0);
}
