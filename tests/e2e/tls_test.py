#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""TLS and certificates of clients, with certificates made here, and what a reload (SIGHUP) changes."""

import contextlib
import http.client
import shutil
import signal
import socket
import ssl
import subprocess
import time
import unittest

from cell import SOURCE, Answer, CellTest, Daemon, wait_until
from certificates import Authority


class TlsTest(CellTest):
    def setUp(self):
        super().setUp()
        self.authority = Authority(self.folder, "root")
        self.certificate, self.key = self.authority.issue("cell7")
        self.tls = (f"server.tls.certificate={self.certificate}", f"server.tls.key={self.key}")

    def start(self, *settings: str, config=SOURCE / "config/demo.toml") -> Daemon:
        daemon = Daemon(self.folder, 9, self.folder / "no-world", *settings, config=config)
        self.programs.append(daemon)
        wait_until("it listens", lambda: not daemon.alive() or "listens on" in daemon.output())
        self.assertTrue(daemon.alive(), daemon.output())
        return daemon

    def trusting(self, client=None, authority: Authority | None = None) -> ssl.SSLContext:
        context = ssl.create_default_context(cafile=(authority or self.authority).certificate)
        if client:
            context.load_cert_chain(*client)
        return context

    def ask(self, daemon: Daemon, context: ssl.SSLContext | None = None, method="GET", path="/api/v1/cell") -> Answer:
        connection = http.client.HTTPSConnection("127.0.0.1", daemon.port, timeout=15, context=context or self.trusting())
        with contextlib.closing(connection):
            connection.request(method, path)
            return Answer(connection.getresponse())

    def serial(self, daemon: Daemon) -> bytes:
        with contextlib.closing(socket.create_connection(("127.0.0.1", daemon.port), timeout=15)) as plain:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
            context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
            with context.wrap_socket(plain) as secure:
                return secure.getpeercert(binary_form=True)

    def test_requests_are_answered_over_tls_and_only_over_tls(self):
        daemon = self.start(*self.tls)
        self.assertEqual(self.ask(daemon).status, 200)
        connection = http.client.HTTPSConnection("127.0.0.1", daemon.port, timeout=15, context=self.trusting())
        with contextlib.closing(connection):
            for _ in range(3):  # on one connection
                connection.request("GET", "/livez")
                self.assertEqual(connection.getresponse().read()[:1], b"{")
        with self.assertRaises((http.client.HTTPException, OSError)):
            daemon.get("/livez")
        curl = subprocess.run(["curl", "-sS", "--cacert", self.authority.certificate, f"https://127.0.0.1:{daemon.port}/livez"],
                              capture_output=True, timeout=20, check=False)
        self.assertEqual(curl.returncode, 0, curl.stderr)
        self.assertIn(b"alive", curl.stdout)
        self.assertLess(daemon.stop(), 3)

    def test_a_large_answer_comes_whole_to_a_client_that_takes_it_bit_by_bit_and_the_connection_goes_on(self):
        daemon = self.start(*self.tls)
        plain = socket.socket()
        plain.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)  # the daemon has to wait for it
        plain.settimeout(15)
        plain.connect(("127.0.0.1", daemon.port))
        with contextlib.closing(self.trusting().wrap_socket(plain, server_hostname="127.0.0.1")) as secure:
            for _ in range(2):
                secure.sendall(b"GET /openapi.json HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
                answer = http.client.HTTPResponse(secure)
                answer.begin()
                body = b""
                while part := answer.read(16384):
                    body += part
                    time.sleep(0.01)
                self.assertEqual(body, self.ask(daemon, path="/openapi.json").body)
                self.assertGreater(len(body), 100_000)

    def test_old_protocols_are_refused(self):
        daemon = self.start(*self.tls)
        for version, works in ((ssl.TLSVersion.TLSv1, False), (ssl.TLSVersion.TLSv1_1, False), (ssl.TLSVersion.TLSv1_2, True),
                               (ssl.TLSVersion.TLSv1_3, True)):
            context = self.trusting()
            context.set_ciphers("ALL:@SECLEVEL=0")
            context.minimum_version = context.maximum_version = version
            with self.subTest(version=version):
                if works:
                    self.assertEqual(self.ask(daemon, context).status, 200)
                else:
                    with self.assertRaises(OSError):
                        self.ask(daemon, context)

    def test_clients_show_a_certificate_where_one_is_asked_for(self):
        stranger = Authority(self.folder, "stranger")
        known, foreign = self.authority.issue("hmi"), stranger.issue("mallory")
        # A client that proves who it is need not have a token: it may be listened to from elsewhere.
        daemon = self.start(*self.tls, f"server.tls.client_ca={self.authority.certificate}", "server.address=0.0.0.0")
        self.assertEqual(self.ask(daemon, self.trusting(known)).status, 200)
        for context in (self.trusting(), self.trusting(foreign)):
            with self.assertRaises((OSError, http.client.HTTPException)):
                self.ask(daemon, context)
        self.assertEqual(self.ask(daemon, self.trusting(known), "DELETE", "/api/v1/calibrations/none").status, 404)
        self.assertIn('"who":"cert:hmi"', (self.folder / "audit.jsonl").read_text())

    def test_a_handshake_that_does_not_go_on_ends_and_takes_a_place_meanwhile(self):
        daemon = self.start(*self.tls, "server.max_connections=1")
        with contextlib.closing(socket.create_connection(("127.0.0.1", daemon.port), timeout=20)) as silent:
            silent.sendall(b"\x16\x03\x01\x02\x00")
            begin = time.monotonic()
            with self.assertRaises((OSError, http.client.HTTPException)):
                self.ask(daemon)
            with contextlib.suppress(ConnectionError):
                while silent.recv(100):
                    pass
            self.assertLess(time.monotonic() - begin, 13)
        wait_until("its place is free", lambda: self.ask(daemon).status == 200, 10)

    def test_files_that_cannot_be_used_stop_the_start_and_are_named(self):
        other_key = self.authority.issue("other")[1]
        broken = self.folder / "broken.pem"
        broken.write_text("nothing")
        for settings, word in (((self.tls[0], f"server.tls.key={other_key}"), "other.key"), ((self.tls[0], f"server.tls.key={broken}"), "broken.pem"),
                               ((f"server.tls.certificate={broken}", self.tls[1]), "broken.pem"), (self.tls[:1], "server.tls.key"),
                               ((*self.tls, f"server.tls.client_ca={broken}"), "broken.pem")):
            daemon = Daemon(self.folder, 9, self.folder / "no-world", *settings)
            self.programs.append(daemon)
            with self.subTest(word=word):
                self.assertEqual(daemon.process.wait(20), 2)
                self.assertIn(word, daemon.output())

    def test_an_encrypted_key_is_opened_with_the_password_of_a_file_that_is_never_shown(self):
        locked, password = self.folder / "locked.key", self.folder / "password"
        password.write_text("s3cr3t-c4n4ry\n")
        self.authority.openssl("pkey", "-in", self.key, "-aes256", "-passout", f"file:{password}", "-out", locked)
        daemon = self.start(self.tls[0], f"server.tls.key={locked}", f"server.tls.key_password_file={password}")
        self.assertEqual(self.ask(daemon).status, 200)
        self.assertNotIn("s3cr3t", daemon.output())
        self.assertNotIn(b"s3cr3t", self.ask(daemon, path="/api/v1/support_bundle").body)

    def test_a_reload_takes_a_new_certificate_and_keeps_the_old_one_when_it_cannot(self):
        daemon = self.start(*self.tls)
        before = self.serial(daemon)
        self.key.write_text("nothing")
        daemon.process.send_signal(signal.SIGHUP)
        wait_until("the fault is told", lambda: "cell7.key" in daemon.output(), 10)
        self.assertEqual(self.serial(daemon), before)
        fresh = self.authority.issue("renewed")
        shutil.copy(fresh[1], self.key)
        shutil.copy(fresh[0], self.certificate)
        daemon.process.send_signal(signal.SIGHUP)
        wait_until("the new certificate is shown", lambda: self.serial(daemon) != before, 10)
        self.assertEqual(self.ask(daemon).status, 200)

    def test_a_reload_applies_what_it_can_and_names_what_takes_a_restart(self):
        text = (SOURCE / "config/demo.toml").read_text().replace('"../', f'"{SOURCE}/')
        config = self.folder / "cell.toml"
        config.write_text(text)
        daemon = self.start(*self.tls, config=config)
        config.write_text(text + '\n[server]\nloopback_rate_limit = 5\nworkspace = 1\n')
        daemon.process.send_signal(signal.SIGHUP)
        wait_until("the fault is told", lambda: "workspace" in daemon.output(), 10)
        config.write_text(text + '\n[server]\nloopback_rate_limit = 5\n\n[log]\nlevel = "debug"\n\n[drift]\ntolerance_mm = 0.6\n')
        daemon.process.send_signal(signal.SIGHUP)
        wait_until("it is told", lambda: "drift.tolerance_mm" in daemon.output(), 10)
        self.assertRegex(daemon.output(), r"applied: .*server\.loopback_rate_limit.*log\.level")
        self.assertRegex(daemon.output(), r"restart.*: drift\.tolerance_mm")
        statuses = {self.ask(daemon, path="/livez").status for _ in range(20)}
        self.assertEqual(statuses, {200, 429})
        self.assertIn("debug: GET /livez", daemon.output())
        daemon.process.send_signal(signal.SIGHUP)
        wait_until("nothing more is told", lambda: daemon.output().count("drift.tolerance_mm") == 2, 10)


if __name__ == "__main__":
    unittest.main()
