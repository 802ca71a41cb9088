# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""A real mosquitto and a real PostgreSQL of a test's own, in its folder, to be killed and started again."""

import os
import pwd
import shutil
import signal
import subprocess
import time
from pathlib import Path

MOSQUITTO = shutil.which("mosquitto") or "/usr/sbin/mosquitto"


def postgres_programs() -> Path | None:
    """Debian keeps them out of the path, a folder a version."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/postgres"), key=lambda path: int(path.parts[-3]))
    return found[-1].parent if found else None


def are_installed() -> bool:
    return os.path.exists(MOSQUITTO) and postgres_programs() is not None and shutil.which("mosquitto_sub") is not None


class Engine:
    process: subprocess.Popen | None = None
    log: Path

    def spawn(self, *words, **options) -> None:
        with self.log.open("a") as log:
            self.process = subprocess.Popen([*map(str, words)], stdin=subprocess.DEVNULL, stdout=log, stderr=log, **options)

    def kill(self) -> None:
        """As a power cut or the kernel's out-of-memory killer: no farewell."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def output(self) -> str:
        return self.log.read_text(errors="replace")


class Mosquitto(Engine):
    """Keeps nothing: a broker that was killed has lost its state."""

    def __init__(self, folder: Path, port: int, *lines: str):
        self.port, self.log = port, folder / "mosquitto.log"
        self.config = folder / "mosquitto.conf"
        account = pwd.getpwuid(os.geteuid()).pw_name
        self.config.write_text("\n".join((f"user {account}", "persistence false", f"listener {port} 127.0.0.1", "allow_anonymous true", *lines, "")))
        self.start()

    def start(self) -> None:
        self.spawn(MOSQUITTO, "-c", self.config)

    def hear(self, topic: str, *options: str, timeout_s: int = 20) -> str:
        """The next message of a topic, a retained one first."""
        words = ["mosquitto_sub", "-V", "5", "-p", str(self.port), "-t", topic, "-C", "1", "-W", str(timeout_s), *options]
        return subprocess.run(words, capture_output=True, text=True, timeout=timeout_s + 10, check=False).stdout.strip()


SHIPPED = Path(__file__).resolve().parents[2] / "deploy/kubernetes/aggregation"


class ShippedMosquitto(Mosquitto):
    """With the configuration and the rules of access that deploy/ ships, as they are but for paths and the port. `accounts`:
    password by user; `more_rules`: of this plant."""

    def __init__(self, folder: Path, port: int, certificate: Path, key: Path, accounts: dict[str, str], more_rules: str = ""):
        passwords = folder / "passwords"
        for user, password in accounts.items():
            create = [] if passwords.exists() else ["-c"]
            subprocess.run(["mosquitto_passwd", "-b", *create, passwords, user, password], check=True, capture_output=True, timeout=20)
        rules = folder / "acl"
        rules.write_text((SHIPPED / "acl").read_text() + "\n" + more_rules)
        rules.chmod(0o600)
        text = (SHIPPED / "mosquitto.conf").read_text()
        for shipped, own in (("listener 8883", f"listener {port} 127.0.0.1"), ("/secrets/tls.crt", str(certificate)), ("/secrets/tls.key", str(key)),
                             ("/secrets/passwords", str(passwords)), ("/config/acl", str(rules))):
            if shipped not in text:
                raise AssertionError(f"mosquitto.conf has no {shipped}")
            text = text.replace(shipped, own)
        self.port, self.log, self.config = port, folder / "mosquitto.log", folder / "mosquitto.conf"
        self.config.write_text(f"user {pwd.getpwuid(os.geteuid()).pw_name}\n" + text)
        self.start()


class Postgres(Engine):
    def __init__(self, folder: Path):
        self.folder, self.log, self.programs = folder / "postgres", folder / "postgres.log", postgres_programs()
        self.folder.mkdir()
        # PostgreSQL refuses to run as root.
        self.account = "postgres" if os.geteuid() == 0 else pwd.getpwuid(os.geteuid()).pw_name
        if os.geteuid() == 0:
            shutil.chown(self.folder, self.account, self.account)
            folder.chmod(0o755)
        self.options = {"user": self.account, "group": self.account, "extra_groups": []} if os.geteuid() == 0 else {}
        self.database = f"host={self.folder} user={self.account} dbname=postgres"
        subprocess.run([self.programs / "initdb", "-D", self.folder / "data", "--no-sync", "-A", "trust", "-E", "UTF8", "--no-locale"], cwd="/",
                       check=True, capture_output=True, timeout=120, **self.options)
        self.start()

    def start(self) -> None:
        self.spawn(self.programs / "postgres", "-D", self.folder / "data", "-k", self.folder, "-c", "listen_addresses=", cwd="/", **self.options)

    def kill(self) -> None:
        """All of it: children that outlive the postmaster would keep a new one from starting."""
        children = subprocess.run(["ps", "-o", "pid=", "--ppid", str(self.process.pid)], capture_output=True, text=True, check=False)
        super().kill()
        for pid in map(int, children.stdout.split()):
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        time.sleep(0.2)  # their shared memory is free once the kernel has ended them

    def ask(self, sql: str) -> list[list[str]] | None:
        """Rows; nothing where it does not answer, or cannot."""
        words = [self.programs / "psql", "-X", "-At", "-F", "\t", "-v", "ON_ERROR_STOP=1", "-d", self.database, "-c", sql]
        answer = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
        return [line.split("\t") for line in answer.stdout.splitlines()] if answer.returncode == 0 else None


class Collector(Engine):
    def __init__(self, folder: Path, program: Path, broker: Mosquitto, postgres: Postgres, *options):
        self.log, self.words = folder / "collector.log", (program, "--port", broker.port, "--database", postgres.database, *options)
        self.start()

    def start(self) -> None:
        self.spawn(*self.words)
