# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Holds answers of the daemon against its OpenAPI document."""

import json
import re
import sys

# Debian's python3-jsonschema is there for the distribution's own Python; the one that runs may be another.
sys.path.append("/usr/lib/python3/dist-packages")

from jsonschema import Draft202012Validator, FormatChecker  # noqa: E402  (scripts/setup.sh installs it)

METHODS = ("get", "post", "put", "patch", "delete")


class Contract:
    def __init__(self, document: dict):
        self.document = document
        self.operations = {item[method]["operationId"]: (method.upper(), path, item[method])
                           for path, item in document["paths"].items() for method in METHODS if method in item}
        self.seen: dict[str, set[str]] = {name: set() for name in self.operations}

    def resolve(self, value: dict) -> dict:
        while "$ref" in value:
            at = self.document
            for key in value["$ref"].removeprefix("#/").split("/"):
                at = at[key]
            value = at
        return value

    def errors(self, schema: dict, value) -> list[str]:
        whole = {"allOf": [schema], "components": self.document["components"]}
        validator = Draft202012Validator(whole, format_checker=FormatChecker())
        return [f"{'/'.join(map(str, error.absolute_path))}: {error.message[:400]}" for error in validator.iter_errors(value)]

    def check(self, name: str, answer) -> None:
        """Raises AssertionError when the answer is not as the operation `name` says."""
        responses = self.operations[name][2]["responses"]
        status = str(answer.status)
        if status not in responses:
            raise AssertionError(f"{name}: {status} is not documented: {answer.body[:300]}")
        response = self.resolve(responses[status])
        self.check_headers(f"{name} {status}", response, answer)
        self.check_body(f"{name} {status}", response, answer)
        self.seen[name].add(status)

    def check_headers(self, what: str, response: dict, answer) -> None:
        documented = {key.lower(): self.resolve(value) for key, value in response.get("headers", {}).items()}
        for key, header in documented.items():
            text = answer.headers.get(key)
            if text is None and (header.get("required") or key == "x-request-id"):
                raise AssertionError(f"{what}: the header {key} is missing")
            if text is None:
                continue
            value = float(text) if header["schema"].get("type") == "number" else text
            if found := self.errors(header["schema"], value):
                raise AssertionError(f"{what}: header {key}: {found}")
        own = {key.lower() for key in answer.headers if key.lower().startswith("calibrd-")}
        unknown = {key for key in own - set(documented) if not re.fullmatch(r"calibrd-sensor-\d+(-[a-z-]+)?", key)}
        if unknown:
            raise AssertionError(f"{what}: headers that are not documented: {unknown}")

    def check_body(self, what: str, response: dict, answer) -> None:
        content = response.get("content")
        if content is None:
            if answer.body:
                raise AssertionError(f"{what}: a body where none is documented")
            return
        media = answer.headers["Content-Type"].split(";")[0]
        if media not in content:
            raise AssertionError(f"{what}: {media} is not documented")
        if media.endswith("json") and (found := self.errors(content[media]["schema"], json.loads(answer.body))):
            raise AssertionError(f"{what}: {found[:5]}")

    def check_event(self, name: str, event: str, data) -> None:
        """Raises AssertionError when a server-sent event of the operation `name` is not as it says."""
        events = self.operations[name][2]["responses"]["200"]["content"]["text/event-stream"]["x-events"]
        if event not in events:
            raise AssertionError(f"{name}: the event {event} is not documented")
        if found := self.errors(events[event], data):
            raise AssertionError(f"{name}: the event {event}: {found[:5]}")

    def flaws(self) -> list[str]:
        """What is wrong with the document itself."""
        found = []
        if not self.document["openapi"].startswith("3.1."):
            found.append("not OpenAPI 3.1")
        for where, value in walk(self.document, "#"):
            if isinstance(value, dict) and isinstance(value.get("$ref"), str):
                try:
                    self.resolve(value)
                except KeyError:
                    found.append(f"{where}: {value['$ref']} leads nowhere")
        for name, schema in self.document["components"]["schemas"].items():
            Draft202012Validator.check_schema({**schema, "components": {}})
            if not schema:
                found.append(f"{name} says nothing")
        for name, (method, path, operation) in self.operations.items():
            found += [f"{name}: {flaw}" for flaw in self.operation_flaws(method, path, operation)]
        return found

    def operation_flaws(self, method: str, path: str, operation: dict):
        parameters = [self.resolve(one) for one in operation.get("parameters", [])]
        named = {one["name"] for one in parameters if one["in"] == "path"}
        if named != set(re.findall(r"\{(\w+)\}", path)):
            yield f"parameters {named} are not those of {path}"
        if not operation.get("summary"):
            yield "no summary"
        if method == "POST" and "activate" not in path and "requestBody" not in operation:
            yield "no body"
        responses = {status: self.resolve(response) for status, response in operation["responses"].items()}
        for status, response in responses.items():
            if status.startswith(("4", "5")) and "application/problem+json" not in response["content"] and status != "503":
                yield f"{status} is no problem+json"
        media = [one for response in responses.values() for one in response.get("content", {}).values()]
        for one in media + list(operation.get("requestBody", {}).get("content", {}).values()):
            examples = [example["value"] for example in one.get("examples", {}).values()]
            for example in examples + ([one["example"]] if "example" in one else []):
                yield from (f"example: {error}" for error in self.errors(one["schema"], example))


def walk(value, where: str):
    yield where, value
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in children:
        if key not in ("example", "examples"):
            yield from walk(child, f"{where}/{key}")
