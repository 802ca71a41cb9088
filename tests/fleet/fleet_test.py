#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""The way of calibrations to PostgreSQL, through a real broker, while each part of it is killed; and what a daemon tells a broker."""

import contextlib
import json
import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "e2e"))
from cell import BIN, BUILD, SENSOR, SOURCE, CellTest, free_port, wait_until  # noqa: E402
from certificates import Authority  # noqa: E402
from engines import SHIPPED, Collector, Mosquitto, Postgres, ShippedMosquitto, are_installed  # noqa: E402
from prometheus import Metrics  # noqa: E402

EXPORTERS = BUILD / "tests/fleet_exporters"


def stored_by_cells(folder: Path) -> set[tuple[str, str]]:
    """What the daemons' own databases hold: the truth."""
    found = set()
    for file in folder.glob("cell-*/calibrd.db"):
        with contextlib.closing(sqlite3.connect(file)) as database:
            found |= {(file.parent.name, row[0]) for row in database.execute("SELECT calibration_id FROM results")}
    return found


@unittest.skipUnless(are_installed(), "mosquitto or PostgreSQL is missing; scripts/setup.sh --fleet brings both")
class Fleet(CellTest):
    def setUp(self):
        super().setUp()
        self.engines = []
        self.addCleanup(self.end_engines)

    def end_engines(self):
        for engine in reversed(self.engines):
            if engine.process.poll() is None:
                engine.kill()
            print(f"--- end of the log of {type(engine).__name__}\n{engine.output()[-2000:]}")

    def start(self, engine):
        self.engines.append(engine)
        return engine

    def start_three(self, *broker_lines, collector_options=()):
        broker = self.start(Mosquitto(self.folder, free_port(), *broker_lines))
        postgres = self.start(Postgres(self.folder))
        collector = self.start(Collector(self.folder, BIN / "calibrd-collector", broker, postgres, *collector_options))
        return broker, postgres, collector

    def exporters(self, broker: Mosquitto, cells: int, per_second: float, seconds: float, drain_s: float) -> subprocess.Popen:
        words = [EXPORTERS, self.folder, cells, broker.port, per_second, seconds, drain_s]
        return subprocess.Popen([*map(str, words)], stdout=subprocess.PIPE, text=True)

    def rows(self, postgres: Postgres) -> list[tuple[str, str]]:
        return [tuple(row) for row in postgres.ask("SELECT cell, calibration_id FROM calibrations") or []]

    def test_nothing_is_lost_and_nothing_is_there_twice_whatever_is_killed(self):
        broker, postgres, collector = self.start_three()
        work = self.exporters(broker, 10, 30, 60, 0)
        for engine, pause_s in ((broker, 1), (postgres, 2), (collector, 1), (broker, 0), (postgres, 0)):
            time.sleep(1.5)
            engine.kill()
            time.sleep(pause_s)
            engine.start()
        time.sleep(1)
        work.kill()  # all daemons, too, with whatever they had not sent
        work.communicate()
        last = self.exporters(broker, 10, 30, 1, 60)
        report = json.loads(last.communicate(timeout=120)[0])
        truth, rows = stored_by_cells(self.folder), self.rows(postgres)
        self.assertTrue(report["drained"], report)
        self.assertGreater(len(truth), 100)
        self.assertEqual((len(rows), set(rows)), (len(truth), truth))
        self.check_documented_queries(postgres)
        print(f"{len(rows)} rows of {len(truth)} calibrations; {report}")

    def check_documented_queries(self, postgres: Postgres):
        block = (SOURCE / "docs/fleet.md").read_text().split("```sql")[1].split("```")[0]
        queries = [query for query in block.split(";") if query.strip()]
        self.assertEqual(len(queries), 4)
        for query in queries:
            self.assertIsNotNone(postgres.ask(query), query + postgres.output()[-1000:])

    def test_a_document_that_cannot_be_stored_holds_up_no_other(self):
        broker, postgres, collector = self.start_three()
        topic = "calibrd/v1/cells/odd/calibrations"
        good = {"id": "good", "sensor": "s", "created_at": "2026-01-01T00:00:00Z", "status": "failed", "method": "full"}
        wait_until("the collector listens", lambda: "connected" in collector.output())
        answers = subprocess.Popen(["mosquitto_sub", "-V", "5", "-p", str(broker.port), "-t", "calibrd/v1/cells/odd/acknowledgements", "-W", "20", "-C", "2"],
                                   stdout=subprocess.PIPE, text=True)
        time.sleep(1)
        for document in ({**good, "id": "bad", "created_at": "yesterday-ish"}, "no json", good):
            text = document if isinstance(document, str) else json.dumps(document)
            subprocess.run(["mosquitto_pub", "-V", "5", "-q", "1", "-p", str(broker.port), "-t", topic, "-m", text], check=True, timeout=20)
        wait_until("the good one is stored", lambda: ("odd", "good") in self.rows(postgres))
        heard = "".join(answers.communicate(timeout=40)[0])
        self.assertIn('"calibration":"bad"', heard)
        self.assertIn('"stored":["good"]', heard)

    def send(self, broker: Mosquitto, *documents):
        for document in documents:
            text = document if isinstance(document, str) else json.dumps(document)
            subprocess.run(["mosquitto_pub", "-V", "5", "-q", "1", "-p", str(broker.port), "-t", "calibrd/v1/cells/odd/calibrations", "-s"],
                           input=text, text=True, check=True, timeout=20)

    def test_what_the_database_does_not_take_now_holds_up_no_other(self):
        broker, postgres, collector = self.start_three()
        good = {"id": "good", "sensor": "s", "created_at": "2026-01-01T00:00:00Z", "status": "failed", "method": "full"}
        wait_until("the tables are there", lambda: (self.send(broker, {**good, "id": "first"}), self.rows(postgres))[1])
        # Errors of a class that may pass, and of one that will not (a limit of PostgreSQL is exceeded).
        postgres.ask("CREATE FUNCTION no() RETURNS trigger LANGUAGE plpgsql AS $$BEGIN IF NEW.calibration_id = 'later' THEN RAISE 'not now'; END IF; "
                     "IF NEW.calibration_id = 'never' THEN RAISE 'too much' USING ERRCODE = '54000'; END IF; RETURN NEW; END$$")
        postgres.ask("CREATE TRIGGER no BEFORE INSERT ON calibrations FOR EACH ROW EXECUTE FUNCTION no()")
        long_name = "".join(random.Random(1).choices("abcdefghijklmnopqrstuvwxyz0123456789", k=20000))
        self.send(broker, {**good, "id": "later"}, {**good, "id": "never"}, {**good, "id": "long", "sensor": long_name}, {**good, "id": "huge", "x": "x" * 2_000_000},
                  {**good, "id": "no name"}, good)
        wait_until("the good one is stored", lambda: ("odd", "good") in self.rows(postgres), 15)
        self.assertEqual({row[1] for row in self.rows(postgres)}, {"first", "good"})
        said = collector.output()
        for words in ("calibration long cannot be stored: its sensor", "calibration never cannot be stored: ", "a message of 2000", "no calibration with an id came on calibrd/v1/cells/odd", "not now"):
            self.assertIn(words, said)
        postgres.ask("DROP TRIGGER no ON calibrations")
        wait_until("the other one is stored", lambda: ("odd", "later") in self.rows(postgres), 15)

    def test_a_collector_ends_though_its_database_does_not_answer(self):
        broker, postgres, collector = self.start_three()
        good = {"id": "good", "sensor": "s", "created_at": "2026-01-01T00:00:00Z", "status": "failed", "method": "full"}
        wait_until("the tables are there", lambda: (self.send(broker, good), self.rows(postgres))[1])
        backends = [int(row[0]) for row in postgres.ask("SELECT pid FROM pg_stat_activity WHERE backend_type = 'client backend' AND pid <> pg_backend_pid()")]
        self.assertEqual(len(backends), 1)
        os.kill(backends[0], signal.SIGSTOP)
        self.addCleanup(os.kill, backends[0], signal.SIGCONT)
        self.send(broker, {**good, "id": "waits"})
        time.sleep(1)
        collector.process.terminate()
        self.assertEqual(collector.process.wait(5), 0)

    def test_what_is_retained_expires_while_a_cell_lives_and_says_so_when_it_has_ended(self):
        broker = self.start(Mosquitto(self.folder, free_port()))
        work = self.exporters(broker, 1, 1000, 300, 0)  # without a collector all that may be on its way is
        self.addCleanup(work.kill)
        base = "calibrd/v1/cells/cell-0"
        topics = (f"{base}/status", f"{base}/sensors/{SENSOR}/pose", f"{base}/sensors/{SENSOR}/state")
        wait_until("the state is told", lambda: broker.hear(topics[2], timeout_s=2))
        for topic in topics:
            left_s = int(broker.hear(topic, "-F", "%E"))
            self.assertTrue(0 < left_s <= 60, f"{topic}: {left_s}")
        self.assertIn("T_base_sensor", broker.hear(topics[1]))
        work.terminate()
        work.wait(30)
        status, pose, state = (json.loads(broker.hear(topic)) for topic in topics)
        self.assertFalse(status["online"])
        self.assertFalse(pose["valid"])
        self.assertNotIn("T_base_sensor", pose)
        self.assertFalse(state["pose_valid"])
        self.assertEqual(state["health"], "lost")
        self.assertEqual([broker.hear(topic, "-F", "%E") for topic in topics], [""] * 3, "the last words stay")

    def check_metrics(self, daemon):
        def told() -> dict[str, float]:
            samples = Metrics(daemon.get("/metrics").body.decode()).samples
            return {name.removeprefix("calibrd_mqtt_"): value for (name, _), value in samples.items() if name.startswith("calibrd_mqtt_")}

        wait_until("nothing waits any more", lambda: told().get("calibrations_waiting") == 0)
        figures = told()
        self.assertGreaterEqual(figures.pop("calibrations_sent_total"), 1)
        self.assertEqual(figures, {"connected": 1, "name_contested": 0, "connects_total": 1, "calibrations_acknowledged_total": 1, "calibrations_refused_total": 0,
                                   "calibrations_waiting": 0})

    def start_shipped(self, authority: Authority) -> tuple[ShippedMosquitto, Postgres]:
        """The broker as deploy/ ships it, with a user more, who reads all; a file `password` with the word of all of them."""
        certificate, key = authority.issue("broker")
        password = self.folder / "password"
        password.write_text("word\n")
        broker = self.start(ShippedMosquitto(self.folder, free_port(), certificate, key, dict.fromkeys(("cell7", "cell8", "collector", "reader"), "word"),
                                             "user reader\ntopic read calibrd/v1/cells/#\n"))
        postgres = self.start(Postgres(self.folder))
        self.start(Collector(self.folder, BIN / "calibrd-collector", broker, postgres, "--tls", "--ca", authority.certificate, "--broker", "localhost",
                             "--username", "collector", "--password-file", password))
        return broker, postgres

    def check_rules_of_access(self, broker: ShippedMosquitto, *with_tls: str):
        """Nobody speaks for a cell but itself, nor for the collector, nor without a password."""
        def publish(user: str, word: str, topic: str) -> str:
            words = ["mosquitto_pub", "-V", "5", "-q", "1", "-p", str(broker.port), "-u", user, "-P", word, *with_tls, "-t", topic, "-m", "{}"]
            done = subprocess.run(words, capture_output=True, text=True, timeout=20, check=False)
            return done.stdout + done.stderr

        self.assertEqual(publish("cell8", "word", "calibrd/v1/cells/cell8/calibrations"), "")
        for user, topic in (("cell8", "calibrd/v1/cells/cell7/status"), ("cell8", "calibrd/v1/collector"), ("collector", "calibrd/v1/cells/cell7/status"),
                            ("reader", "calibrd/v1/cells/cell7/status")):
            self.assertIn("Not authorized", publish(user, "word", topic), f"{user} may write {topic}")
        self.assertIn("ot authorized", publish("cell8", "guess", "calibrd/v1/cells/cell8/status"))

    def test_the_documented_rules_of_access_are_those_that_are_shipped(self):
        shipped = [line for line in (SHIPPED / "acl").read_text().splitlines() if not line.startswith("#")]
        self.assertIn("\n".join(shipped), (SOURCE / "docs/fleet.md").read_text())

    def test_a_daemon_tells_pose_state_and_its_own_end_through_the_broker_that_is_shipped(self):
        authority = Authority(self.folder, "root")
        broker, postgres = self.start_shipped(authority)
        tls = ("--cafile", str(authority.certificate), "-h", "localhost")
        with_tls = ("-u", "reader", "-P", "word", *tls)
        simulator = self.simulate()
        simulator.hurry()
        daemon = self.serve(simulator, "mqtt.host=localhost", f"mqtt.port={broker.port}", "mqtt.cell=cell7", "mqtt.tls.enabled=true",
                            f"mqtt.tls.ca={authority.certificate}", "mqtt.username=cell7", f"mqtt.password_file={self.folder / 'password'}").wait_ready()
        result = daemon.calibrate(postures=3)
        base = "calibrd/v1/cells/cell7"
        pose = wait_until("a valid pose is told", lambda: (told if (told := json.loads(broker.hear(f"{base}/sensors/{SENSOR}/pose", *with_tls)))["valid"] else None))
        self.assertEqual(pose["T_base_sensor"], daemon.pose()["T_base_sensor"])
        self.assertIn("valid_until", pose)
        self.assertEqual(json.loads(broker.hear(f"{base}/sensors/{SENSOR}/state", *with_tls))["health"], "streaming")
        self.assertTrue(json.loads(broker.hear(f"{base}/status", *with_tls))["online"])
        row = wait_until("the calibration is in PostgreSQL", lambda: postgres.ask(
            "SELECT calibration_id, verdict, t_base_sensor FROM newest_poses JOIN calibrations USING (cell, sensor_id, calibration_id)"))
        self.assertEqual(row[0][:2], [result["id"], "accepted"])
        self.assertEqual(json.loads(row[0][2]), result["result"]["T_base_sensor"])
        self.check_metrics(daemon)
        self.check_rules_of_access(broker, *tls)
        daemon.process.kill()
        wait_until("the last will", lambda: not json.loads(broker.hear(f"{base}/status", *with_tls))["online"])


if __name__ == "__main__":
    if not are_installed():
        sys.exit(77)  # ctest tells it as skipped
    unittest.main()
