// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// What no schema knows of a pod: that what it names is there, and that it may do no more than it needs.

const PRIVILEGED_KEYS = ["hostNetwork", "hostPID", "hostIPC"];

/** Volumes that the Pod Security level "restricted" lets pods have; "baseline" forbids hostPath alone. */
const RESTRICTED_VOLUMES = ["configMap", "csi", "downwardAPI", "emptyDir", "ephemeral", "persistentVolumeClaim", "projected", "secret"];

/** What the namespace's Pod Security level refuses: no schema and no dry run on another namespace tells. */
function levelFaults(name, spec, level) {
  if (level === "privileged") return [];
  const kinds = (spec.volumes ?? []).flatMap((volume) => Object.keys(volume).filter((key) => key !== "name"));
  const refused = kinds.filter((kind) => (level === "restricted" ? !RESTRICTED_VOLUMES.includes(kind) : kind === "hostPath"));
  const faults = refused.map((kind) => `${name} mounts a ${kind}, which its namespace (${level}) refuses`);
  if (level === "restricted" && !["RuntimeDefault", "Localhost"].includes(spec.securityContext?.seccompProfile?.type))
    faults.push(`${name} has no seccompProfile, which its namespace (${level}) refuses`);
  return faults;
}

function containerFaults(name, container, volumes) {
  const faults = [];
  const rights = container.securityContext ?? {};
  if (rights.privileged) faults.push("is privileged");
  if (rights.allowPrivilegeEscalation !== false) faults.push("may gain rights");
  if (rights.readOnlyRootFilesystem !== true) faults.push("may write its root file system");
  if (!rights.capabilities?.drop?.includes("ALL")) faults.push("keeps capabilities");
  for (const mount of container.volumeMounts ?? [])
    if (!volumes.includes(mount.name)) faults.push(`mounts a volume ${mount.name} that is not there`);
  for (const variable of container.env ?? []) // where it is shown by whoever lists processes, with the final newline of its file
    if (variable.valueFrom?.secretKeyRef) faults.push(`has a secret in its environment: ${variable.name}`);
  const ports = (container.ports ?? []).map((port) => port.name);
  for (const probe of [container.startupProbe, container.livenessProbe, container.readinessProbe]) {
    const port = probe?.httpGet?.port ?? probe?.tcpSocket?.port;
    if (typeof port === "string" && !ports.includes(port)) faults.push(`probes a port ${port} that it does not have`);
  }
  return faults.map((fault) => `${name}/${container.name} ${fault}`);
}

/** References of a pod to configuration, secrets and claims that are not among `known`, by kind. */
function referenceFaults(name, spec, known) {
  const named = (spec.volumes ?? []).map((volume) =>
    volume.configMap ? ["configMap", volume.configMap.name] : volume.secret ? ["secret", volume.secret.secretName]
      : ["claim", volume.persistentVolumeClaim?.claimName]).filter(([, what]) => what);
  return named.filter(([kind, what]) => !known[kind].includes(what)).map(([kind, what]) => `${name} names a ${kind} ${what} that is not there`);
}

/** What is wrong with the pods of `object`; `known` has the names of what they may name, by kind, and their namespace's `level`. */
export function podFaults(object, known) {
  const spec = object.spec?.template?.spec;
  if (!spec) return [];
  const name = `${object.kind} ${object.metadata.name}`;
  const volumes = [...(spec.volumes ?? []), ...(object.spec.volumeClaimTemplates ?? []).map((claim) => claim.metadata)].map((v) => v.name);
  const faults = [...(spec.initContainers ?? []), ...spec.containers].flatMap((container) => containerFaults(name, container, volumes));
  if (spec.securityContext?.runAsNonRoot !== true) faults.push(`${name} may run as root`);
  if (spec.automountServiceAccountToken !== false) faults.push(`${name} gets a token of the cluster`);
  for (const key of PRIVILEGED_KEYS) if (spec[key]) faults.push(`${name} has ${key}`);
  const labels = object.spec.template.metadata.labels;
  for (const [key, value] of Object.entries(object.spec.selector?.matchLabels ?? {}))
    if (labels[key] !== value) faults.push(`${name} selects ${key}=${value}, which its pods are not`);
  return [...faults, ...levelFaults(name, spec, known.level), ...referenceFaults(name, spec, known)];
}
