#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""What cannot be used stops the start with exit status 2 and one message that names it and says what to do."""

import shutil
import socket
import subprocess
import unittest
from pathlib import Path

from cell import BIN, OF_THIS_BUILD, SENSOR, SOURCE, URDF, CellTest, call, wait_until


class BadInput(CellTest):
    def run_daemon(self, *settings: str, config: Path = SOURCE / "config/demo.toml"):
        own = (f"storage.path={self.folder / 'calibrd.db'}", "server.port=0", "robot.port=9", *OF_THIS_BUILD)
        options = [word for setting in (*own, *settings) for word in ("--set", setting)]
        return subprocess.run([BIN / "calibrd", "serve", "--config", config, *options], cwd=self.folder, timeout=20,
                              capture_output=True, text=True, check=False)

    def expect_refused(self, ended, *words: str):
        print(ended.stderr.strip().splitlines()[-1] if ended.stderr.strip() else "(no message)")
        self.assertEqual(ended.returncode, 2, ended.stderr)
        for word in words:
            self.assertIn(word, ended.stderr)

    def robot_copy(self) -> Path:
        shutil.copytree(URDF.parents[1], self.folder / "demo_arm7")
        return self.folder / "demo_arm7/urdf/demo_arm7.urdf"

    def changed_urdf(self, old: str, new: str) -> str:
        urdf = self.robot_copy()
        text = urdf.read_text()
        self.assertIn(old, text)
        urdf.write_text(text.replace(old, new))
        return f"robot.urdf={urdf}"

    def test_intrinsics_that_look_like_defaults_are_a_warning_of_the_check(self):
        check = [BIN / "calibrd", "serve", "--config", SOURCE / "config/demo.toml", "--check-config"]
        check += [word for setting in OF_THIS_BUILD for word in ("--set", setting)]
        cases = {(): 0, ("cx=255.5", "cy=211.5"): 1, ("cx=256", "cy=212", "distortion=[0,0,0,0,0]"): 2}
        for settings, warnings in cases.items():
            options = [word for setting in settings for word in ("--set", f"sensors.{SENSOR}.{setting}")]
            ended = subprocess.run([*check, *options], cwd=SOURCE, timeout=20, capture_output=True, text=True, check=False)
            with self.subTest(settings=settings):
                self.assertEqual(ended.returncode, 0, ended.stderr)
                self.assertEqual(ended.stderr.count("like defaults"), warnings, ended.stderr)
                self.assertIn("the configuration is good", ended.stdout)

    def test_files_of_a_fleet_are_checked_but_keep_no_daemon_down(self):
        check = [BIN / "calibrd", "serve", "--config", SOURCE / "config/demo.toml", "--check-config"]
        broker = ("mqtt.host=127.0.0.1", "mqtt.port=9", "mqtt.cell=cell7", "mqtt.username=cell7")
        wrong = {"mqtt.password_file=/nonexistent/password": "/nonexistent/password", "mqtt.tls.ca=/nonexistent/ca.pem": "mqtt.tls.enabled",
                 "mqtt.username=": "the configuration is good"}
        for setting, said in wrong.items():
            options = [word for one in (*OF_THIS_BUILD, *broker, setting) for word in ("--set", one)]
            with self.subTest(setting):
                ended = subprocess.run([*check, *options], cwd=SOURCE, timeout=20, capture_output=True, text=True, check=False)
                self.assertIn(said, ended.stdout + ended.stderr)
                self.assertEqual(ended.returncode, 0 if "good" in said else 2, ended.stderr)
        daemon = self.serve(self.simulate(), *broker, "mqtt.password_file=/nonexistent/password").wait_alive()
        wait_until("it is said", lambda: "/nonexistent/password" in daemon.output())

    def test_a_port_in_use(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            self.expect_refused(self.run_daemon(f"server.port={port}"), str(port))

    def test_output_that_cannot_be_written(self):
        for redirection in (">/dev/full", ">&-"):
            ended = subprocess.run(["sh", "-c", f'exec "$0" config-reference {redirection}', BIN / "calibrd"],
                                   stderr=subprocess.PIPE, text=True, timeout=20, check=False)
            self.expect_refused(ended, "stdout")

    def test_numbers_of_calibrate_that_are_none(self):
        options = {"--table-height": ("nan", "inf", "1e400", "10.1", "high", ""), "--workspace": ("nan,0,0", "1e400,0,0"),
                   "--guess": ("nan,0,0,0,0,0,1", "1e400,0,0,0,0,0,1"), "--roi": ("nan,0,0,1,1,1", "0,0,0,1,1,1e400")}
        for option, values in options.items():
            for value in values:
                method = ("--method", "paper") if option == "--roi" else ()
                ended = subprocess.run([BIN / "calibrd", "calibrate", self.folder, "--suggest", *method, f"{option}={value}"],
                                       capture_output=True, text=True, timeout=20, check=False)
                with self.subTest(option=option, value=value):
                    self.expect_refused(ended, value)
                    self.assertNotIn("capture.json", ended.stderr, "the number was taken")

    def test_a_mistyped_key_is_named_with_its_line_and_the_nearest_name(self):
        config = self.folder / "typo.toml"
        config.write_text('[robot]\nurdf = "a.urdf"\nhots = "127.0.0.1"\n')
        self.expect_refused(self.run_daemon(config=config), "typo.toml", "3", "hots", "host")

    def test_a_value_out_of_range(self):
        self.expect_refused(self.run_daemon("sensors.kinect2.fx=-1"), "fx")

    def test_a_configuration_that_is_not_toml(self):
        config = self.folder / "broken.toml"
        config.write_text("[robot\n")
        self.expect_refused(self.run_daemon(config=config), "broken.toml", "1")

    def test_a_missing_configuration(self):
        self.expect_refused(self.run_daemon(config=self.folder / "none.toml"), "none.toml")

    def test_a_missing_urdf(self):
        self.expect_refused(self.run_daemon("robot.urdf=/nowhere/arm.urdf"), "/nowhere/arm.urdf")

    def test_a_broken_urdf(self):
        urdf = self.robot_copy()
        urdf.write_text(urdf.read_text()[:700])
        self.expect_refused(self.run_daemon(f"robot.urdf={urdf}"), str(urdf))

    def test_a_urdf_with_a_joint_without_parent(self):
        self.expect_refused(self.run_daemon(self.changed_urdf('parent link="turret"', 'parent link="tower"')), "urdf")

    def test_a_missing_mesh(self):
        self.expect_refused(self.run_daemon(self.changed_urdf("turret.stl", "tower.stl")), "tower.stl")

    def test_a_broken_mesh(self):
        urdf = self.robot_copy()
        (urdf.parents[1] / "meshes/turret.stl").write_bytes(b"solid nothing")
        # Else package:// would find the whole mesh of the built robot first.
        search_paths = f"robot.search_paths=['{urdf.parents[2]}']"
        self.expect_refused(self.run_daemon(f"robot.urdf={urdf}", search_paths), "turret.stl")

    def test_an_unknown_joint_is_named_with_the_nearest_one(self):
        self.expect_refused(self.run_daemon("robot.joints.joint_z.sign=-1"), "joint_z")

    def test_an_unknown_base_link(self):
        self.expect_refused(self.run_daemon("robot.base_link=bass_link"), "bass_link")

    def test_a_controller_frame_that_is_no_link_or_moves(self):
        self.expect_refused(self.run_daemon("robot.controller_frame=bass"), "robot.controller_frame", "bass", "'base'")
        self.expect_refused(self.run_daemon("robot.controller_frame=forearm"), "robot.controller_frame", "forearm", "joint",
                            "stands still")

    def test_a_storage_folder_that_cannot_be_made(self):
        self.expect_refused(self.run_daemon("storage.path=/proc/none/calibrd.db"), "/proc/none")

    def test_a_driver_folder_that_is_not_there(self):
        self.expect_refused(self.run_daemon("sensors.kinect2.driver_directory=/nowhere"), "/nowhere")

    def test_a_file_that_is_no_database(self):
        (self.folder / "text.db").write_text("this is no database, but a text of more than a hundred bytes " * 4)
        self.expect_refused(self.run_daemon(f"storage.path={self.folder / 'text.db'}"), "text.db")

    def test_a_store_that_another_daemon_uses(self):
        simulator = self.simulate()
        first = self.serve(simulator).wait_ready()
        job = first.start_calibration(postures=50)
        self.expect_refused(self.run_daemon(), "calibrd.db", "another calibrd", "storage.path")
        self.assertEqual(first.json(job)["status"], "collecting")
        call(first.port, "DELETE", job)
        self.assertEqual(first.json(job)["status"], "cancelled", "its end could not be stored")


if __name__ == "__main__":
    unittest.main(verbosity=2)
