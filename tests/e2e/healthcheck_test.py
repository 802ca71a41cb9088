#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""`calibrd healthcheck`: one question to the daemon of a configuration, one line, status 0 or 1, within its time."""

import contextlib
import os
import signal
import socket
import subprocess
import threading
import time
import unittest

from cell import BIN, OF_THIS_BUILD, SLOWNESS, SOURCE, CellTest, Daemon, free_port, wait_until
from certificates import Authority


class Peer(threading.Thread):
    """Listens where a daemon should, and answers with given bytes, or never."""

    def __init__(self, answer: bytes = b"", pause_s: float = 0):
        super().__init__(daemon=True)
        self.answer, self.pause_s = answer, pause_s
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.start()

    def run(self):
        with contextlib.suppress(OSError), self.listener, self.listener.accept()[0] as connection:
            while connection.recv(4096) and self.answer:
                for byte in self.answer:  # each by itself: a deadline for each part alone would never end
                    connection.sendall(bytes([byte]))
                    time.sleep(self.pause_s)
                return


class HealthcheckTest(CellTest):
    def start(self, *settings: str) -> Daemon:
        daemon = Daemon(self.folder, 9, self.folder / "no-world", *settings)
        self.programs.append(daemon)
        wait_until("it listens", lambda: not daemon.alive() or "listens on" in daemon.output())
        self.assertTrue(daemon.alive(), daemon.output())
        return daemon

    def check(self, port: int, *words, settings=()) -> subprocess.CompletedProcess:
        own = (*OF_THIS_BUILD, f"server.port={port}", *settings)
        options = [word for setting in own for word in ("--set", setting)]
        done = subprocess.run([BIN / "calibrd", "healthcheck", "--config", SOURCE / "config/demo.toml", *options, *map(str, words)],
                              capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual((done.stdout + done.stderr).count("\n"), 1, done)
        return done

    def assert_unwell(self, done: subprocess.CompletedProcess, *words: str):
        self.assertEqual((done.returncode, done.stdout), (1, ""), done)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_a_daemon_without_its_cell_is_alive_and_not_ready(self):
        daemon = self.start()
        well = self.check(daemon.port)
        self.assertEqual((well.returncode, well.stdout), (0, f"http://127.0.0.1:{daemon.port}/livez: alive\n"))
        self.assert_unwell(self.check(daemon.port, "--ready"), "/readyz: not ready")

    def test_a_daemon_with_its_cell_is_ready(self):
        daemon = self.serve(self.simulate()).wait_ready()
        ready = self.check(daemon.port, "--ready")
        self.assertEqual((ready.returncode, ready.stdout), (0, f"http://127.0.0.1:{daemon.port}/readyz: ready\n"))

    def test_it_needs_no_token_and_finds_a_daemon_of_any_interface(self):
        settings = (f"server.tokens_file={self.folder / 'tokens.json'}", "server.address=0.0.0.0")
        subprocess.run([BIN / "calibrd", "token", "create", "hmi", "--tokens-file", self.folder / "tokens.json"],
                       check=True, capture_output=True, timeout=20)
        daemon = self.start(*settings)
        self.assertEqual(daemon.get("/api/v1/cell").status, 401)
        self.assertEqual(self.check(daemon.port, settings=settings).returncode, 0)

    def test_a_daemon_that_is_not_there_or_stands_still_is_not_well(self):
        self.assert_unwell(self.check(free_port()), "nothing listens there")
        daemon = self.start()
        os.kill(daemon.process.pid, signal.SIGSTOP)
        begin = time.monotonic()
        self.assert_unwell(self.check(daemon.port, "--timeout", 1), "no answer within 1.0 s")
        self.assertLess(time.monotonic() - begin, 3 * SLOWNESS)
        os.kill(daemon.process.pid, signal.SIGCONT)
        self.assertEqual(self.check(daemon.port).returncode, 0)

    def test_the_deadline_is_for_all_of_it(self):
        slow = Peer(b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n{}", pause_s=0.2)  # 8 s in all
        begin = time.monotonic()
        self.assert_unwell(self.check(slow.port, "--timeout", 1), "no answer within 1.0 s")
        self.assertLess(time.monotonic() - begin, 3 * SLOWNESS)

    def test_what_answers_otherwise_is_not_well_and_is_told(self):
        head = b"HTTP/1.1 %s\r\nContent-Length: %d\r\n\r\n%s"
        reason = b'{"alive":false,"reason":"robot link has not gone on"}'
        for answer, words in ((head % (b"503 No", len(reason), reason), "not alive: robot link has not gone on"),
                              (head % (b"404 No", 2, b"{}"), "answered 404"),
                              (head % (b"200 OK", 99, b"{}"), "no whole answer"),
                              (b"SSH-2.0-OpenSSH_9\r\n", "no whole answer"),
                              (head % (b"200 OK", 100_000, b"x"), "no whole answer")):
            with self.subTest(words=words):
                self.assert_unwell(self.check(Peer(answer).port), words)

    def test_what_cannot_be_asked_is_not_well(self):
        self.assert_unwell(self.check(0), "server.port is 0")
        self.assert_unwell(self.check(8080, settings=("server.prot=1",)), "server.prot")
        self.assert_unwell(self.check(8080, settings=("server.address=cell7",)), "cell7")

    def test_over_tls_it_believes_the_loopback_address_or_an_authority(self):
        authority, stranger = Authority(self.folder, "root"), Authority(self.folder, "stranger")
        certificate, key = authority.issue("cell7")
        tls = (f"server.tls.certificate={certificate}", f"server.tls.key={key}")
        daemon = self.start(*tls)
        ca = ("--ca", authority.certificate)
        for words in ((), ca, (*ca, "--name", "localhost")):
            with self.subTest(words=words):
                self.assertEqual(self.check(daemon.port, *words, settings=tls).returncode, 0)
        for words, line in ((("--ca", stranger.certificate), "not believed"), ((*ca, "--name", "cell8"), "not believed"),
                            (("--ca", key), "holds no certificate")):
            with self.subTest(words=words):
                self.assert_unwell(self.check(daemon.port, *words, settings=tls), line)
        elsewhere = (*tls, "server.address=192.0.2.7", "server.allow_unauthenticated=true")
        self.assert_unwell(self.check(daemon.port, settings=elsewhere), "other than loopback", "--ca")
        self.assert_unwell(self.check(daemon.port), "server.tls")  # the daemon speaks TLS, the configuration does not

    def test_it_shows_a_certificate_where_one_is_asked_for(self):
        authority = Authority(self.folder, "root")
        certificate, key = authority.issue("cell7")
        tls = (f"server.tls.certificate={certificate}", f"server.tls.key={key}", f"server.tls.client_ca={authority.certificate}")
        daemon = self.start(*tls)
        self.assert_unwell(self.check(daemon.port, settings=tls), "--certificate and --key")
        known = authority.issue("docker")
        shown = self.check(daemon.port, "--certificate", known[0], "--key", known[1], settings=tls)
        self.assertEqual(shown.returncode, 0, shown)


if __name__ == "__main__":
    unittest.main()
