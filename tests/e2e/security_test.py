#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Who may do what: tokens and their scopes on every route, names and pages, rates, addresses listened on, and the audit log."""

import contextlib
import http.client
import json
import re
import signal
import socket
import stat
import subprocess
import time
import unittest

from cell import BIN, OF_THIS_BUILD, SENSOR, SLOWNESS, SOURCE, Answer, CellTest, Daemon, wait_until

OPEN, READ, CALIBRATE, ADMIN = range(4)
SCOPES = ("open", "read", "calibrate", "admin")

# Every route and the least scope that may use it.
ROUTES = [
    ("GET", "/livez", OPEN), ("GET", "/readyz", OPEN), ("GET", "/openapi.json", OPEN), ("GET", "/docs", OPEN), ("GET", "/", OPEN), ("GET", "/assets/none", OPEN),
    ("GET", "/docs/docs.js", OPEN), ("GET", "/docs/docs.css", OPEN), ("GET", "/api/v1/calibrations/none/diff/none", READ), ("GET", "/readyz?verbose", READ), ("GET", "/nowhere", READ),
    ("PUT", "/livez", READ), ("OPTIONS", "/api/v1/cell", READ), ("HEAD", "/api/v1/cell", READ),
    ("GET", f"/api/v1/sensors/{SENSOR}/pose", READ), ("GET", "/api/v1/sensors", READ), ("GET", f"/api/v1/sensors/{SENSOR}", READ),
    ("GET", "/api/v1/cell", READ), ("GET", "/api/v1/robot", READ), ("GET", f"/api/v1/sensors/{SENSOR}/drift", READ),
    ("GET", "/api/v1/events", READ), ("GET", "/api/v1/cell/obstacles", READ), ("GET", "/api/v1/cell/cross-checks", READ),
    ("GET", "/api/v1/cell/cloud", READ), ("GET", f"/api/v1/sensors/{SENSOR}/clouds/measured", READ),
    ("GET", f"/api/v1/sensors/{SENSOR}/clouds/virtual", READ), ("GET", f"/api/v1/sensors/{SENSOR}/clouds/residual", READ),
    ("GET", f"/api/v1/sensors/{SENSOR}/next-posture", READ), ("GET", f"/api/v1/sensors/{SENSOR}/calibrations", READ),
    ("GET", "/api/v1/session", OPEN), ("GET", f"/api/v1/sensors/{SENSOR}/frames", READ), ("GET", "/api/v1/robot/joints", READ),
    ("GET", "/api/v1/robot/urdf", READ), ("GET", "/api/v1/robot/links/none/mesh", READ),
    ("GET", "/metrics", READ), ("GET", "/api/v1/calibrations/none", READ), ("GET", "/api/v1/calibrations/none/capture", READ),
    ("GET", "/api/v1/robot/motions", READ), ("GET", "/api/v1/robot/motions/none", READ),
    ("POST", f"/api/v1/sensors/{SENSOR}/calibrations", CALIBRATE), ("POST", "/api/v1/cell/calibrations", CALIBRATE),
    ("DELETE", "/api/v1/calibrations/none", CALIBRATE), ("POST", "/api/v1/calibrations/none/activate", CALIBRATE),
    ("POST", f"/api/v1/sensors/{SENSOR}/captures", CALIBRATE), ("DELETE", "/api/v1/robot/motions/none", CALIBRATE),
    ("POST", "/api/v1/robot/motions", ADMIN), ("GET", "/api/v1/support_bundle", ADMIN),
]


def ask(port: int, method: str, path: str, token: str = "", address: str = "127.0.0.1", body: bytes = b"", **headers: str) -> Answer:
    """As call(), with a token; of an answer without an end, its beginning."""
    sent = {name.replace("_", "-"): value for name, value in headers.items()}
    if token:
        sent["Authorization"] = f"Bearer {token}"
    if body:
        sent["Content-Type"] = "application/json"
    connection = http.client.HTTPConnection(address, port, timeout=20)
    with contextlib.closing(connection):
        connection.request(method, path, body or None, sent)
        response = connection.getresponse()
        if response.length is None:  # it has no end
            response.length = 1
        return Answer(response)


class Security(CellTest):
    def setUp(self):
        super().setUp()
        self.tokens_file = self.folder / "tokens.json"
        self.guarded = f"server.tokens_file={self.tokens_file}"

    def token(self, *words: str) -> subprocess.CompletedProcess:
        return subprocess.run([BIN / "calibrd", "token", *words, "--tokens-file", self.tokens_file], capture_output=True, text=True,
                              timeout=20, check=False)

    def create(self, name: str, scope: str) -> str:
        made = self.token("create", name, "--scope", scope)
        self.assertEqual(made.returncode, 0, made.stderr)
        return made.stdout.strip()

    def start(self, *settings: str) -> Daemon:
        """Without robot and sensor: who may ask does not depend on them."""
        self.programs.append(Daemon(self.folder, 9, self.folder / "no-world", *settings))
        return self.programs[-1].wait_alive()

    def audit(self) -> list[dict]:
        return [json.loads(line) for line in (self.folder / "audit.jsonl").read_text().splitlines()]

    def test_every_route_asks_for_its_scope(self):
        tokens = {READ: self.create("page", "read"), CALIBRATE: self.create("hmi", "calibrate"), ADMIN: self.create("boss", "admin")}
        daemon = self.start(self.guarded, "server.loopback_rate_limit=0")
        body = b'{"postures": 1, "timeout_s": 0.1, "route": "none"}'
        for method, path, least in ROUTES:
            sent = body if method == "POST" else b""
            for has, token in ((OPEN, ""), *tokens.items()):
                with self.subTest(method=method, path=path, has=SCOPES[has]):
                    answer = ask(daemon.port, method, path, token, body=sent)
                    if has >= least:
                        self.assertNotEqual(answer.status, 401)
                        if answer.status == 403:
                            self.assertEqual(answer.json()["code"], "motion_disabled")
                    elif has == OPEN:
                        self.assertEqual(answer.status, 401)
                        self.assertEqual(answer.headers["WWW-Authenticate"], 'Bearer realm="calibrd"')
                    else:
                        self.assertEqual(answer.status, 403)
                        self.assertIn(f'scope="{SCOPES[least]}"', answer.headers["WWW-Authenticate"])
                        self.assertEqual(answer.json()["code"], "scope_too_small")

    def test_every_route_of_the_sources_is_in_the_list(self):
        known = {(method, path.replace(SENSOR, "{id}").replace("none", "{id}")) for method, path, _ in ROUTES}
        for file in (SOURCE / "api/routes").glob("*_routes.cpp"):
            text = file.read_text()
            for start in (at for at in range(len(text)) if text.startswith("router.add(", at) or text.startswith("add_one(", at)):
                words = text[start:start + 200].split('"')
                if len(words) > 3 and words[1] in ("GET", "POST", "DELETE", "PUT") and words[3].startswith("/"):
                    path = re.sub(r"{\w+}", "{id}", words[3])
                    found = any(method == words[1] and (route == path or path.endswith("/") and route.startswith(path))
                                for method, route in known)
                    self.assertTrue(found, f"{file.name}: {words[1]} {path} is not tested here")

    def test_a_token_counts_from_its_creation_to_its_revocation_and_is_written_nowhere(self):
        daemon = self.start(self.guarded)
        self.assertIn("holds no token yet", daemon.output())
        self.assertEqual(ask(daemon.port, "GET", "/api/v1/cell").json()["code"], "token_needed")
        token = self.create("hmi", "read")
        self.assertEqual(len(token), len("calibrd_") + 43)
        wait_until("the token is known", lambda: ask(daemon.port, "GET", "/api/v1/cell", token).status == 200, 5)
        self.assertEqual(stat.S_IMODE(self.tokens_file.stat().st_mode), 0o600)
        listed = self.token("list")
        self.assertRegex(listed.stdout, r"^hmi\tread\t20\d\d-")
        events = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=10)
        events.request("GET", "/api/v1/events", headers={"Authorization": f"Bearer {token}"})
        stream = events.getresponse()
        self.assertEqual(stream.status, 200)
        self.assertEqual(self.token("revoke", "hmi").returncode, 0)
        begin = time.monotonic()
        while stream.readline():  # what goes on ends with its token
            self.assertLess(time.monotonic() - begin, 5 * SLOWNESS)
        events.close()
        refused = ask(daemon.port, "GET", "/api/v1/cell", token)
        self.assertEqual((refused.status, refused.json()["code"]), (401, "token_unknown"))
        self.assertIn("invalid_token", refused.headers["WWW-Authenticate"])
        daemon.stop()
        secret = token.removeprefix("calibrd_").encode()
        self.assertNotIn(secret, refused.body)
        for file in self.folder.rglob("*"):
            if file.is_file():
                self.assertNotIn(secret, file.read_bytes(), file)

    def test_tokens_that_cannot_be_are_refused_with_the_reason(self):
        self.create("hmi", "read")
        for words, reason in ((("create", "hmi"), "revoke it first"), (("create", "a b"), "letters"), (("create", "x", "--scope", "root"), "scope"),
                              (("revoke", "none"), "token list"), (("create",), "name"), ((), "subcommand")):
            with self.subTest(words=words):
                refused = self.token(*words)
                self.assertEqual(refused.returncode, 2)
                self.assertEqual(refused.stdout, "")
                self.assertIn(reason, refused.stderr)
        self.tokens_file.chmod(0o644)
        self.assertIn("chmod 600", self.token("list").stderr)

    def refused_start(self, *settings: str) -> str:
        own = (f"storage.path={self.folder / 'calibrd.db'}", "server.port=0", "robot.port=9", *OF_THIS_BUILD)
        options = [word for setting in (*own, *settings) for word in ("--set", setting)]
        for check in ([], ["--check-config"]):
            ended = subprocess.run([BIN / "calibrd", "serve", "--config", SOURCE / "config/demo.toml", *options, *check],
                                   cwd=self.folder, timeout=20, capture_output=True, text=True, check=False)
            self.assertEqual(ended.returncode, 2, ended.stderr)
        return ended.stderr

    def test_it_does_not_listen_to_the_network_without_tokens_unless_told_to(self):
        for address in ("0.0.0.0", "::"):
            message = self.refused_start(f"server.address={address}")
            for word in (address, "server.tokens_file", "server.allow_unauthenticated"):
                self.assertIn(word, message)
        self.tokens_file.write_text("no tokens")
        self.tokens_file.chmod(0o600)
        self.assertIn(str(self.tokens_file), self.refused_start(self.guarded))
        self.tokens_file.unlink()
        allowed = self.start("server.address=0.0.0.0", "server.allow_unauthenticated=true")
        self.assertIn("may do everything", allowed.output())
        self.assertEqual(ask(allowed.port, "GET", "/api/v1/cell").status, 200)
        allowed.stop()
        self.create("hmi", "read")
        guarded = self.start("server.address=0.0.0.0", self.guarded)
        self.assertEqual(ask(guarded.port, "GET", "/api/v1/cell").status, 401)

    def test_by_default_only_this_machine_is_listened_to(self):
        daemon = self.start()
        probe = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        with contextlib.closing(probe), contextlib.suppress(OSError):
            probe.connect(("192.0.2.1", 9))  # sends nothing; tells the address others see
            own = probe.getsockname()[0]
            if not own.startswith("127."):
                with self.assertRaises(ConnectionRefusedError):
                    socket.create_connection((own, daemon.port), timeout=5)

    def test_other_names_and_pages_of_other_sites_are_refused(self):
        daemon = self.start('server.hosts=["cell7.example"]')
        cases = (({}, 200), ({"Host": "cell7.example"}, 200), ({"Host": "evil.example"}, 421), ({"Host": "localhost.evil.example"}, 421),
                 ({"Origin": f"http://127.0.0.1:{daemon.port}"}, 200), ({"Origin": "http://evil.example"}, 403), ({"Origin": "null"}, 403),
                 ({"Sec_Fetch_Site": "cross-site"}, 403))
        for headers, status in cases:
            with self.subTest(headers=headers):
                answer = ask(daemon.port, "GET", "/api/v1/cell", **headers)
                self.assertEqual(answer.status, status, answer.body)
        refused = ask(daemon.port, "POST", f"/api/v1/sensors/{SENSOR}/calibrations", Origin="http://evil.example")
        self.assertEqual(refused.json()["code"], "wrong_origin")

    def test_too_many_requests_are_refused_and_served_again(self):
        daemon = self.start("server.loopback_rate_limit=20")
        statuses = [ask(daemon.port, "GET", "/livez") for _ in range(60)]
        refused = [answer for answer in statuses if answer.status == 429]
        self.assertTrue(refused)
        self.assertEqual(refused[0].headers["Retry-After"], "1")
        self.assertEqual(refused[0].json()["code"], "too_many_requests")
        wait_until("it is served again", lambda: ask(daemon.port, "GET", "/livez").status == 200, 5)

    def test_who_changed_what_stands_in_the_audit_log(self):
        token = self.create("hmi", "calibrate")
        simulator = self.simulate()
        daemon = self.serve(simulator, self.guarded)
        daemon.wait_alive()
        wait_until("robot and sensor are up", lambda: ask(daemon.port, "GET", "/readyz").status == 200)
        started = ask(daemon.port, "POST", f"/api/v1/sensors/{SENSOR}/calibrations", token, body=b'{"postures": 50}')
        self.assertEqual(started.status, 202, started.body)
        job = started.headers["Location"]
        self.assertEqual(ask(daemon.port, "DELETE", job, token).status, 200)
        self.assertEqual(ask(daemon.port, "DELETE", "/api/v1/calibrations/none", token).status, 404)
        ask(daemon.port, "GET", "/api/v1/cell", token)
        done = [(line["who"], line["what"], line["status"], line["result"]) for line in self.audit()]
        self.assertEqual(done, [("hmi", f"POST /api/v1/sensors/{SENSOR}/calibrations", 202, "done"), ("hmi", f"DELETE {job}", 200, "done"),
                                ("hmi", "DELETE /api/v1/calibrations/none", 404, "refused")])
        self.assertEqual(self.audit()[0]["made"], job)
        self.assertEqual(self.audit()[0]["from"], "127.0.0.1")
        self.assertEqual(stat.S_IMODE((self.folder / "audit.jsonl").stat().st_mode), 0o600)

    def test_what_no_request_changed_stands_in_the_audit_log_too(self):
        token = self.create("hmi", "read")
        daemon = self.start(self.guarded)
        self.create("late", "calibrate")
        daemon.process.send_signal(signal.SIGHUP)
        wanted = {("tokens file", "tokens", "done", "made late (calibrate)"), ("SIGHUP", "configuration", "done", "none")}

        def lines() -> set[tuple]:
            ask(daemon.port, "GET", "/api/v1/cell", token)  # tokens are looked at when they are needed
            if not (self.folder / "audit.jsonl").exists():
                return set()
            return {(line["who"], line["what"], line["result"], line.get("detail")) for line in self.audit()}
        wait_until("both are told", lambda: lines() == wanted, 10)

    def test_a_change_that_cannot_be_audited_is_in_the_log(self):
        (self.folder / "audit.jsonl").mkdir()
        daemon = self.start()
        ask(daemon.port, "DELETE", "/api/v1/calibrations/none")
        self.assertIn("DELETE /api/v1/calibrations/none", wait_until("it is told", lambda: (
            text if "audit log" in (text := daemon.output()) else None), 5))
        self.assertIn("local", daemon.output())


if __name__ == "__main__":
    unittest.main()
