// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Two cells made from the template, by another name for the cell, have nothing in common: above all, who asks for the pose
// of the one is not answered by the other.
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import yaml from "js-yaml";

const OF_THE_CLUSTER = ["PersistentVolume", "Namespace"];

/** What kustomize does to names, namespaces, labels and selectors; of each object a copy. */
export function rendered(kustomization, objects) {
  const { nameSuffix = "", namespace, labels = [] } = kustomization;
  const chosen = Object.assign({}, ...labels.filter((label) => label.includeSelectors).map((label) => label.pairs));
  return objects.map((object) => {
    const copy = structuredClone(object);
    copy.metadata.name += nameSuffix;
    if (!OF_THE_CLUSTER.includes(copy.kind)) copy.metadata.namespace = namespace;
    if (copy.kind === "Service") Object.assign((copy.spec.selector ??= {}), chosen);
    if (copy.spec?.template) {
      Object.assign(((copy.spec.selector ??= {}).matchLabels ??= {}), chosen);
      Object.assign(copy.spec.template.metadata.labels, chosen);
    }
    return copy;
  });
}

/** The objects of the kustomization in `folder`, whose files say `to` for each `from`. */
function renamed(folder, from, to) {
  const load = (file) => yaml.loadAll(readFileSync(join(folder, file), "utf-8").replaceAll(from, to));
  const [kustomization] = load("kustomization.yaml");
  const files = kustomization.resources.filter((file) => existsSync(join(folder, file)));
  return rendered(kustomization, files.flatMap(load));
}

export function selectorOf(object) {
  return object.kind === "Service" ? object.spec.selector : object.spec?.selector?.matchLabels;
}

const selects = (selector, labels) => Object.entries(selector).every(([key, value]) => labels[key] === value);

/** What only one cell may have: names of objects, its secrets, its folder on a node. */
function ownedBy(object) {
  const secrets = (object.spec?.template?.spec.volumes ?? []).filter((volume) => volume.secret);
  return [`${object.kind} ${object.metadata.name}`, ...secrets.map((volume) => `secret ${volume.secret.secretName}`),
    ...(object.spec?.local ? [`folder ${object.spec.local.path}`] : [])];
}

/** Faults of two cells from the template in `folder`, whose own cell is named by its nameSuffix. */
export function cellFaults(folder) {
  const { nameSuffix } = yaml.load(readFileSync(join(folder, "kustomization.yaml"), "utf-8"));
  if (!nameSuffix) return [];
  const own = nameSuffix.slice(1), other = `${own}-other`;
  const first = renamed(folder, own, own), second = renamed(folder, own, other);
  const pods = second.filter((object) => object.spec?.template);
  const faults = [];
  for (const object of first.filter(selectorOf)) {
    const name = `${object.kind} ${object.metadata.name}`;
    if (pods.some((pod) => selects(selectorOf(object), pod.spec.template.metadata.labels)))
      faults.push(`${name} selects pods of another cell as well`);
    if (!first.some((pod) => pod.spec?.template && selects(selectorOf(object), pod.spec.template.metadata.labels)))
      faults.push(`${name} selects no pod of its cell`);
  }
  for (const service of first.filter((object) => object.kind === "Service" && !object.spec.publishNotReadyAddresses))
    faults.push(`Service ${service.metadata.name} hides a daemon that is not ready, and its pose`);
  const taken = first.flatMap(ownedBy);
  return [...faults, ...second.flatMap(ownedBy).filter((what) => taken.includes(what)).map((what) => `two cells have one ${what}`)];
}
