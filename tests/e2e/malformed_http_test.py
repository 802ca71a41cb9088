#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Requests that are none, byte by byte, against the daemon itself: each is answered 4xx, or not at all where the client
left, nothing of it is in the answer, the connection ends, and the daemon goes on."""

import contextlib
import json
import re
import socket
import time
import unittest

from cell import SLOWNESS, CellTest, Daemon

HOST = b"Host: localhost\r\n"
CANARY = b"c4n4ry"  # what must not come back
POST = b"POST /api/v1/sensors/kinect2/calibrations HTTP/1.1\r\n" + HOST


def first_line(line: bytes) -> bytes:
    return line + b"\r\n" + HOST + b"\r\n"


def target(path: bytes) -> bytes:
    return first_line(b"GET " + path + b" HTTP/1.1")


def fields(lines: bytes) -> bytes:
    return b"GET /livez HTTP/1.1\r\n" + HOST + lines + b"\r\n"


def body(lines: bytes, content: bytes = b"") -> bytes:
    return POST + lines + b"\r\n" + content


FIRST_LINES = [first_line(line) for line in (
    b"", b" ", b"GET", b"GET /livez", b"GET /livez ", b"GET  /livez HTTP/1.1", b"GET /livez  HTTP/1.1", b" GET /livez HTTP/1.1",
    b"GET /livez HTTP/1.1 ", b"GET\t/livez\tHTTP/1.1", b"/livez HTTP/1.1", b"GET /livez HTTP/0.9", b"GET /livez HTTP/1.2",
    b"GET /livez HTTP/2.0", b"GET /livez HTTP/3", b"GET /livez HTTP/1.10", b"GET /livez HTTP/11", b"GET /livez http/1.1",
    b"GET /livez HTTPS/1.1", b"GET /livez HTTP/1.1 c4n4ry", b"G(T /livez HTTP/1.1", b"GET\x00 /livez HTTP/1.1",
    b"G\x80T /livez HTTP/1.1", b"\xff\xff\xff /livez HTTP/1.1", b"A" * 17 + b" /livez HTTP/1.1", b"GET" * 3000 + b" / HTTP/1.1",
    b"PRI * HTTP/2.0", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", b"\x00" * 32, b"SSH-2.0-c4n4ry",
    b"GET /livez\x0bHTTP/1.1")]

TARGETS = [target(path) for path in (
    b"*", b"livez", b"http://localhost/livez", b"https://c4n4ry.example/livez", b"localhost:80", b"//\x7f", b"\\livez", b"/c4n4ry#x",
    b"/..", b"/../livez", b"/livez/..", b"/api/v1/../../livez", b"/./livez", b"/.", b"/%2e%2e/livez", b"/%2E", b"/.%2e/livez",
    b"/api%2fv1", b"/api%2Fv1", b"/api%5cv1", b"/%00", b"/livez%00c4n4ry", b"/%0d%0aSet-Cookie:%20c4n4ry", b"/%09", b"/%7f",
    b"/%", b"/%2", b"/%zz", b"/%u0041", b"/livez?%", b"/livez?a=%2", b"/livez?a=%00", b"/livez?a=%ff", b"/%ff", b"/%c3", b"/%c0%af",
    b"/%e0%80%80", b"/%ed%a0%80", b"/%f5%80%80%80", b"/\xc3\xa4", b"/\xff", b"/<script>c4n4ry</script>", b"/\"c4n4ry\"", b"/{id}",
    b"/a|b", b"/a^b", b"/a`b", b"/a\x01b", b"/" + b"a" * 9000)]

FIELDS = [fields(lines) for lines in (
    b"X: a\nY: b\r\n", b"X: a\rY: b\r\n", b"X: a\r\r\n", b"X: a\x00c4n4ry\r\n", b"X: a\x01\r\n", b"X: a\x1f\r\n", b"X: a\x7f\r\n",
    b"X: a\r\n c4n4ry\r\n", b"X: a\r\n\tc4n4ry\r\n", b" X: a\r\n", b"\tX: a\r\n", b"X : a\r\n", b"X\t: a\r\n", b": c4n4ry\r\n",
    b"c4n4ry\r\n", b"X y: a\r\n", b"X(y): a\r\n", b"X\x80: a\r\n", b"X\x00: a\r\n", b"\"X\": a\r\n",
    HOST, b"host: c4n4ry.example\r\n", b"X: " + b"a" * 9000 + b"\r\n", b"X: a\r\n" * 65, b"X" * 9000 + b": a\r\n",
    b"X: " + b"a" * (1 << 20) + b"\r\n", b"Authorization: Bearer a\r\nAuthorization: Bearer c4n4ry\r\n",
    b"Origin: http://localhost\r\nOrigin: http://c4n4ry\r\n", b"Content-Type: a\r\nContent-Type: b\r\n")]

HOSTS = [b"GET /livez HTTP/1.1\r\n" + lines + b"\r\n" for lines in (
    b"", b"Host:\r\n", b"Host: \r\n", b"Host: a b\r\n", b"Host: c4n4ry@localhost\r\n", b"Host: localhost/c4n4ry\r\n",
    b"Host: localhost:\r\n", b"Host: localhost:x\r\n", b"Host: localhost:65536\r\n", b"Host: localhost:-1\r\n",
    b"Host: [::1\r\n", b"Host: [c4n4ry]\r\n", b"Host: localhost, localhost\r\n", b"Host: <c4n4ry>\r\n", b"Hos: localhost\r\n")]

FRAMING = [body(*parts) for parts in (
    (b"Content-Length: 2\r\nContent-Length: 2\r\n", b"{}"), (b"Content-Length: 2\r\nContent-Length: 3\r\n", b"{} "),
    (b"Content-Length: 2, 2\r\n", b"{}"), (b"Content-Length: -1\r\n",), (b"Content-Length: +2\r\n", b"{}"), (b"Content-Length: 0x2\r\n", b"{}"),
    (b"Content-Length: 2 2\r\n", b"{}"), (b"Content-Length: 1e1\r\n",), (b"Content-Length:\r\n",), (b"Content-Length: c4n4ry\r\n",),
    (b"Content-Length: 99999999999999999999999\r\n",), (b"Content-Length: 18446744073709551617\r\n",), (b"Content-Length: 70000\r\n",),
    (b"Content-Length: 2\r\nTransfer-Encoding: chunked\r\n", b"0\r\n\r\n"),
    (b"Transfer-Encoding: chunked\r\nContent-Length: 2\r\n", b"0\r\n\r\n"), (b"Transfer-Encoding: identity\r\n",),
    (b"Transfer-Encoding: gzip\r\n",), (b"Transfer-Encoding: gzip, chunked\r\n",), (b"Transfer-Encoding: chunked, chunked\r\n",),
    (b"Transfer-Encoding: \x0bchunked\r\n",), (b"Transfer-Encoding: xchunked\r\n",), (b"Transfer-Encoding:\r\n",),
    (b"Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n",), (b"Transfer-Encoding : chunked\r\n",),
    (b"Transfer-Encoding: chunked\r\n", b"c4n4ry\r\n"), (b"Transfer-Encoding: chunked\r\n", b"-1\r\n{}\r\n0\r\n\r\n"),
    (b"Transfer-Encoding: chunked\r\n", b"2\r\n{}x0\r\n\r\n"),
    (b"Transfer-Encoding: chunked\r\n", b"fffffffffffffffff\r\n{}"), (b"Transfer-Encoding: chunked\r\n", b"11170\r\n" + b"a" * 70000),
    (b"Transfer-Encoding: chunked\r\n", b"2;" + b"c4n4ry" * 30000 + b"\r\n{}\r\n0\r\n\r\n"))]

BODIES = [body(b"Content-Type: application/json\r\nContent-Length: %d\r\nConnection: close\r\n" % len(content), content) for content in (
    b"{", b"[1]", b"\xff\xfe", b"{\"c\": NaN}", b"{} {}", b"{\"a\":1,\"a\":2}", b"[" * 30000, b"{\"a\":" * 10000, b"\x00", b"{\"postures\":1e999}",
    b"{\"guess\":" + b"[" * 17 + b"]" * 17 + b"}")]

OLD = [b"POST /livez HTTP/1.0\r\n" + HOST + b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n", b"GET /livez HTTP/1.0\r\n\r\n"]
ALL = FIRST_LINES + TARGETS + FIELDS + HOSTS + FRAMING + BODIES + OLD


def exchange(port: int, request: bytes, timeout_s: float = 15.0) -> tuple[bytes, float]:
    """Everything that comes back until the daemon ends the connection, and how long that took (s)."""
    begin, answer = time.monotonic(), b""
    with contextlib.closing(socket.create_connection(("127.0.0.1", port), timeout=timeout_s)) as connection:
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):  # it may have heard enough
            connection.sendall(request)
        with contextlib.suppress(ConnectionResetError):
            while piece := connection.recv(65536):
                answer += piece
                if b"\r\n\r\n" in answer:  # it ends its side first, then waits for ours
                    with contextlib.suppress(OSError):
                        connection.shutdown(socket.SHUT_WR)
    return answer, time.monotonic() - begin


class MalformedHttp(CellTest):
    def start(self, *settings: str) -> Daemon:
        self.programs.append(Daemon(self.folder, 9, self.folder / "no-world", *settings))
        return self.programs[-1].wait_alive()

    def check(self, request: bytes, answer: bytes):
        head, _, content = answer.partition(b"\r\n\r\n")
        self.assertRegex(head, rb"^HTTP/1\.1 4\d\d ", request[:200])
        self.assertNotIn(CANARY, answer)
        self.assertNotIn(b"\r\nSet-Cookie", head)
        self.assertRegex(head.lower(), rb"connection: close")
        length = int(re.search(rb"(?i)content-length: (\d+)", head)[1])
        self.assertEqual(len(content), length, "more than one answer, or half of one")
        problem = json.loads(content)
        self.assertTrue(problem["code"] and problem["remedy"], problem)

    def test_each_is_answered_4xx_and_the_connection_ends(self):
        self.assertGreaterEqual(len(ALL), 100)
        daemon = self.start()
        for number, request in enumerate(ALL):
            with self.subTest(number=number, request=request[:120]):
                answer, took_s = exchange(daemon.port, request)
                self.check(request, answer)
                self.assertLess(took_s, 5 * SLOWNESS, "its end was waited for")
        self.assertEqual(daemon.get("/livez").status, 200)
        self.assertTrue(daemon.alive())
        self.assertNotIn(CANARY.decode(), daemon.output(), "what a client sends is no business of the log")
        print(f"{len(ALL)} malformed requests, each refused")

    def test_nothing_that_follows_a_malformed_request_is_answered(self):
        daemon = self.start()
        follower = b"DELETE /api/v1/robot/motions/c4n4ry HTTP/1.1\r\n" + HOST + b"\r\n"
        for request in FRAMING + TARGETS[:5]:
            with self.subTest(request=request[:120]):
                answer, _ = exchange(daemon.port, request + follower)
                self.assertEqual(len(re.findall(rb"HTTP/1\.1 \d\d\d ", answer)), 1, answer)

    def test_requests_cut_off_anywhere_leave_no_trace(self):
        daemon = self.start()
        whole = body(b"Content-Type: application/json\r\nContent-Length: 2\r\n", b"{}")
        for end in range(0, len(whole), 7):
            with contextlib.closing(socket.create_connection(("127.0.0.1", daemon.port), timeout=5)) as connection:
                connection.sendall(whole[:end])
        self.assertEqual(daemon.get("/livez").status, 200)

    def test_a_header_and_a_body_that_trickle_in_have_a_deadline_in_all(self):
        daemon = self.start()
        lines_without_return = body(b"Transfer-Encoding: chunked\r\n", b"2\n{}\n0\n\n")  # the end of the first is waited for
        for start in (b"GET /livez HTTP/1.1\r\n", body(b"Content-Length: 100\r\n"), lines_without_return):
            with self.subTest(start=start), contextlib.closing(
                    socket.create_connection(("127.0.0.1", daemon.port), timeout=0.5)) as connection:
                begin = time.monotonic()
                connection.sendall(start)
                with contextlib.suppress(ConnectionError):
                    while time.monotonic() - begin < 20:
                        connection.sendall(b"a")  # each byte comes well before any deadline for a single read
                        with contextlib.suppress(TimeoutError):
                            if not connection.recv(1000):
                                break
                self.assertLess(time.monotonic() - begin, 13 * SLOWNESS)
                self.assertGreater(time.monotonic() - begin, 8, "a slow client was not given its time")


if __name__ == "__main__":
    unittest.main()
