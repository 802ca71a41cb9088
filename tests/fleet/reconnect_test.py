#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""A client of ours finds its broker again, whatever it was that ended the connection; the collector stands for both clients. Two daemons
of one name, which end each other's connections, find out."""

import contextlib
import json
import socket
import subprocess
import sys
import threading
import time
import unittest
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "e2e"))
from cell import BIN, BUILD, SENSOR, CellTest, free_port, wait_until  # noqa: E402
from certificates import Authority  # noqa: E402
from engines import Collector, Mosquitto, are_installed  # noqa: E402

EXPORTERS = BUILD / "tests/fleet_exporters"
NO_DATABASE = SimpleNamespace(database="host=/nonexistent")


class StrictBroker:
    """Lets a client in (MQTT 5), and does with what it subscribes to what mosquitto cannot be made to."""

    def __init__(self, answer_to_subscription):
        self.answer_to_subscription, self.connections = answer_to_subscription, 0
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        with contextlib.suppress(OSError):
            while True:
                connection, _ = self.listener.accept()
                self.connections += 1
                with connection:
                    self.answer(connection)

    def answer(self, connection: socket.socket):
        while first := connection.recv(1):
            length, shift, more = 0, 0, True
            while more:
                byte = connection.recv(1)[0]
                length, shift, more = length | (byte & 127) << shift, shift + 7, byte > 127
            body = b""
            while len(body) < length:
                body += connection.recv(length - len(body))
            if first[0] == 0x10:  # CONNECT
                connection.sendall(b"\x20\x03\x00\x00\x00")
            if first[0] == 0x82:  # SUBSCRIBE
                connection.sendall(self.answer_to_subscription(body[:2]))

    def close(self):
        self.listener.close()


@unittest.skipUnless(are_installed(), "mosquitto or PostgreSQL is missing; scripts/setup.sh --fleet brings both")
class Reconnect(CellTest):
    def setUp(self):
        super().setUp()
        self.engines = []
        self.addCleanup(self.end_engines)

    def end_engines(self):
        for engine in reversed(self.engines):
            if engine.process.poll() is None:
                engine.kill()
            print(f"--- end of the log of {type(engine).__name__}, {self.id()}\n{engine.output()[-2000:]}")

    def start(self, engine):
        self.engines.append(engine)
        return engine

    def start_both(self, *broker_lines, collector_options=()):
        broker = self.start(Mosquitto(self.folder, free_port(), *broker_lines))
        wait_until("the broker listens", lambda: socket.create_connection(("127.0.0.1", broker.port), 1).close() is None)
        return broker, self.start(Collector(self.folder, BIN / "calibrd-collector", broker, NO_DATABASE, *collector_options))

    def wait_connected(self, collector: Collector, times: int):
        wait_until(f"connection {times}", lambda: collector.output().count("connected to the broker") >= times, 20)

    def set_password(self, password: str):
        subprocess.run(["mosquitto_passwd", "-b", "-c", self.folder / "users", "cell", password], check=True, capture_output=True, timeout=20)

    def restart(self, broker: Mosquitto):
        broker.kill()
        broker.start()

    def test_after_a_password_that_was_refused(self):
        (self.folder / "password").write_text("right\n")
        self.set_password("right")
        broker, collector = self.start_both(f"password_file {self.folder / 'users'}",
                                            collector_options=("--username", "cell", "--password-file", self.folder / "password"))
        self.wait_connected(collector, 1)
        self.set_password("another")
        self.restart(broker)
        wait_until("the refusal is said", lambda: "refuses the connection" in collector.output())
        self.set_password("right")
        self.restart(broker)
        self.wait_connected(collector, 2)

    def test_after_a_broker_that_said_good_bye(self):
        broker, collector = self.start_both()
        self.wait_connected(collector, 1)
        broker.process.terminate()
        broker.process.wait(10)
        broker.start()
        self.wait_connected(collector, 2)
        self.assertIn("no connection to the broker", collector.output())

    def test_after_a_broker_that_threw_it_out(self):
        broker = StrictBroker(lambda _: b"\xe0\x02\x8e\x00")  # DISCONNECT: session taken over
        self.addCleanup(broker.close)
        collector = self.start(Collector(self.folder, BIN / "calibrd-collector", broker, NO_DATABASE))
        wait_until("a second connection", lambda: broker.connections >= 2, 20)
        self.assertIn("taken over", collector.output())

    def test_a_broker_may_come_last(self):
        port = free_port()
        collector = self.start(Collector(self.folder, BIN / "calibrd-collector", SimpleNamespace(port=port), NO_DATABASE))
        wait_until("its absence is said", lambda: "no connection" in collector.output())
        self.start(Mosquitto(self.folder, port))
        self.wait_connected(collector, 1)

    def test_after_another_client_took_its_name(self):
        broker, collector = self.start_both()
        self.wait_connected(collector, 1)
        subprocess.run(["mosquitto_sub", "-V", "5", "-i", "calibrd-collector", "-p", str(broker.port), "-t", "x", "-E"], check=True, timeout=20)
        self.wait_connected(collector, 2)

    def tls(self, name: str) -> list[Path]:
        """Of an authority of this name: its own certificate, the broker's, and its key."""
        folder = self.folder / name
        folder.mkdir()
        authority = Authority(folder, name)
        return [authority.certificate, *authority.issue("broker")]

    def take(self, files: list[Path]):
        """What a broker shows from its next start on."""
        for source, name in zip(files[1:], ("broker.pem", "broker.key")):
            (self.folder / name).write_bytes(source.read_bytes())

    def test_after_a_certificate_of_a_stranger_and_a_power_cut_under_tls(self):
        right, wrong = self.tls("right"), self.tls("wrong")
        self.take(right)
        broker, collector = self.start_both(f"certfile {self.folder / 'broker.pem'}", f"keyfile {self.folder / 'broker.key'}",
                                            collector_options=("--tls", "--ca", right[0], "--broker", "localhost"))
        self.wait_connected(collector, 1)
        self.take(wrong)
        self.restart(broker)
        wait_until("the failure is said", lambda: "TLS" in collector.output())
        self.take(right)
        self.restart(broker)
        self.wait_connected(collector, 2)

    def test_a_subscription_that_is_refused_is_said_and_asked_for_again(self):
        asked = []
        broker = StrictBroker(lambda number: asked.append(number) or b"\x90\x04" + number + b"\x00\x87")  # not authorised
        self.addCleanup(broker.close)
        collector = self.start(Collector(self.folder, BIN / "calibrd-collector", broker, NO_DATABASE))
        said = wait_until("the refusal is said", lambda: [line for line in collector.output().splitlines() if "refuses the subscription" in line])
        self.assertIn("calibrd/v1/cells/+/calibrations", said[0])
        self.assertIn("access control list", said[0])
        wait_until("it is asked for again", lambda: len(asked) > 1)
        self.assertEqual(broker.connections, 1)

    def test_options_that_would_send_a_password_in_clear_are_refused(self):
        done = subprocess.run([BIN / "calibrd-collector", "--ca", "/x.pem"], capture_output=True, text=True, timeout=20, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--tls", done.stderr)

    def test_two_daemons_of_one_name_tell_no_valid_pose(self):
        broker = self.start(Mosquitto(self.folder, free_port()))
        poses, topic = self.folder / "poses.txt", f"calibrd/v1/cells/cell-0/sensors/{SENSOR}/pose"

        def told() -> list[dict]:
            return [json.loads(line) for line in poses.read_text().splitlines(keepends=True) if line.endswith("\n")]

        def begin(name: str) -> subprocess.Popen:
            work = subprocess.Popen(list(map(str, [EXPORTERS, self.folder / name, 1, broker.port, 0.01, 300, 0])), stdout=subprocess.DEVNULL)
            self.addCleanup(work.kill)
            return work

        begin("one")
        wait_until("its pose is told", lambda: '"valid": true' in broker.hear(topic, timeout_s=2))
        with poses.open("w") as file:
            listener = subprocess.Popen(["mosquitto_sub", "-V", "5", "-p", str(broker.port), "-t", topic], stdout=file)
        self.addCleanup(listener.kill)
        wait_until("it is heard", told)
        second = begin("two")
        wait_until("it is contested", lambda: "mqtt.cell" in told()[-1]["reason"] if told()[-1]["reason"] else False)
        count = len(told())
        time.sleep(15)  # they take turns
        self.assertFalse([pose for pose in told()[count:] if pose["valid"]])
        second.kill()
        wait_until("one that is alone is believed again", lambda: told()[-1]["valid"], 90)

    def test_an_end_is_prompt_also_where_no_broker_is(self):
        broker, collector = self.start_both()
        self.wait_connected(collector, 1)
        broker.kill()
        wait_until("the loss is said", lambda: "no connection" in collector.output())
        collector.process.terminate()
        begin = time.monotonic()
        self.assertEqual(collector.process.wait(10), 0)
        self.assertLess(time.monotonic() - begin, 3)


if __name__ == "__main__":
    if not are_installed():
        sys.exit(77)  # ctest tells it as skipped
    unittest.main()
