// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
// Shows openapi.json. Text is only ever set as text, never as HTML.
'use strict';

const METHODS = ['get', 'post', 'put', 'patch', 'delete'];
let api = {};

function element(name, content = [], attributes = {}) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  for (const child of [content].flat()) made.append(child);
  return made;
}

/** `code` and **bold** of the descriptions. */
function prose(text = '') {
  const parts = text.split(/(`[^`]+`|\*\*[^*]+\*\*)/).map((part) => {
    if (part.startsWith('`')) return element('code', part.slice(1, -1));
    if (part.startsWith('**')) return element('strong', part.slice(2, -2).replaceAll('`', ''));
    return part;
  });
  return element('span', parts);
}

function resolve(value) {
  if (!value || !value.$ref) return value;
  return value.$ref.slice(2).split('/').reduce((at, key) => at[key], api);
}

function nameOf(schema) {
  if (schema.$ref) return schema.$ref.split('/').pop();
  for (const key of ['oneOf', 'anyOf', 'allOf']) if (schema[key] && !schema.properties) return schema[key].map(nameOf).join(key === 'allOf' ? ' and ' : ' or ');
  if ('const' in schema) return JSON.stringify(schema.const);
  if (schema.enum) return schema.enum.map((value) => JSON.stringify(value)).join(' | ');
  if (schema.type === 'array' && schema.items) return 'list of ' + nameOf(schema.items);
  return [schema.type ?? 'any'].flat().join(' or ');
}

function rows(schema, prefix, depth) {
  const resolved = resolve(schema) ?? {};
  if (depth > 3) return [];
  if (resolved.type === 'array' && resolved.items) return rows(resolved.items, prefix + '[]', depth + 1);
  const inner = [...(resolved.oneOf ?? []), ...(resolved.anyOf ?? []), ...(resolved.allOf ?? [])];
  if (!resolved.properties) return inner.filter((one) => one.$ref || one.properties).flatMap((one) => rows(one, prefix, depth + 1));
  const required = resolved.required ?? [];
  return Object.entries(resolved.properties).flatMap(([key, value]) => {
    const path = prefix ? prefix + '.' + key : key;
    const text = value.description ?? resolve(value)?.description ?? '';
    const type = nameOf(value) + (required.includes(key) ? '' : ', optional');
    const row = element('tr', [element('td', element('code', path)), element('td', type), element('td', prose(text))]);
    return [row, ...rows(value, path, depth + 1)];
  });
}

function table(schema) {
  const body = rows(schema, '', 0);
  return body.length === 0 ? '' : element('details', [element('summary', 'members: ' + nameOf(schema)), element('table', body)]);
}

function examples(media) {
  const all = media.examples ? Object.entries(media.examples).map(([name, one]) => [name, one.value]) : [];
  if ('example' in media) all.push(['example', media.example]);
  return all.map(([name, value]) => element('details', [element('summary', name.replaceAll('_', ' ')), element('pre', typeof value === 'string' ? value : JSON.stringify(value, null, 2))]));
}

function contents(content = {}) {
  return Object.entries(content).map(([type, media]) => element('div', [element('code', type), ' ', table(media.schema ?? {}), ...examples(media)]));
}

function parameters(operation) {
  const list = (operation.parameters ?? []).map(resolve);
  const lines = list.map((one) => element('tr', [element('td', element('code', one.name)), element('td', one.in + (one.required ? ', required' : '')),
    element('td', nameOf(one.schema)), element('td', prose(one.description))]));
  return lines.length === 0 ? '' : element('table', lines);
}

function responses(operation) {
  return Object.entries(operation.responses).map(([status, one]) => [status, resolve(one)]).map(([status, response]) => element('div', [element('h4', status), prose(response.description), ...contents(response.content)]));
}

function section(method, path, operation) {
  const body = operation.requestBody;
  return element('section', [
    element('h3', [element('span', method.toUpperCase(), { class: 'method' }), element('code', path)]),
    element('p', operation.summary + '.'), element('p', prose(operation.description)), parameters(operation),
    ...(body ? [element('h4', 'Body'), prose(body.description), ...contents(body.content)] : []), ...responses(operation)],
  { id: operation.operationId });
}

function show(tag) {
  const list = element('ul');
  const main = document.getElementById('operations');
  main.append(element('h2', tag.description));
  for (const [path, item] of Object.entries(api.paths)) for (const method of METHODS) {
    const operation = item[method];
    if (!operation || operation.tags[0] !== tag.name) continue;
    list.append(element('li', element('a', [element('span', method.toUpperCase() + ' '), path], { href: '#' + operation.operationId }), { class: 'sub' }));
    main.append(section(method, path, operation));
  }
  document.getElementById('contents').append(element('strong', tag.description), list);
}

async function start() {
  const main = document.getElementById('operations');
  api = await (await fetch('openapi.json')).json();
  main.replaceChildren(...api.info.description.split('\n\n').map((part) => element('p', prose(part))));
  api.tags.forEach(show);
  if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();
}

start().catch((why) => document.getElementById('operations').replaceChildren(element('p', 'openapi.json could not be read: ' + why)));
