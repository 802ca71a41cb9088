#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Shows that layering.py finds what it is there to find."""

import tempfile
import unittest
from pathlib import Path

from layering import violations


def check(files: dict[str, str]) -> list[str]:
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return violations(Path(folder))


GOOD = {
    "core/a.hpp": "#include <Eigen/Core>\n",
    "core/a.cpp": '#include "core/a.hpp"\n#include <embree3/rtcore.h>\n',
    "core/paper/pcl/entry.cpp": '#include "core/a.hpp"\n#include <pcl/point_cloud.h>\n',
    "core/j.cpp": "#include <boost/json.hpp>\n",
    "core/r/scene.hpp": "#include <embree3/rtcore.h>\n",
    "core/r/view.hpp": "#include <Eigen/Core>\n",
    "core/r/view.cpp": '#include "core/r/scene.hpp"\n#include "core/r/view.hpp"\n',
    "drivers/sensor/s.hpp": '#include "core/a.hpp"\n',
    "drivers/sensor/s.cpp": '#include "drivers/sensor/s.hpp"\n#include <OpenNI.h>\n',
    "drivers/sim/world.cpp": "#include <OpenNI.h>\n#include <boost/asio.hpp>\n",
    "api/r.cpp": '#include "core/a.hpp"\n#include <boost/beast.hpp>\n',
    "fleet/messages/topics.hpp": "#include <string>\n",
    "fleet/mqtt/client.cpp": "#include <mosquitto.h>\n",
    "fleet/exporter/exporter.hpp": '#include "api/r.hpp"\n#include "fleet/messages/topics.hpp"\n',
    "fleet/collector/warehouse.cpp": '#include <libpq-fe.h>\n#include "fleet/messages/topics.hpp"\n',
    "server/fleet_link.cpp": '#include "fleet/exporter/exporter.hpp"\n',
    "server/main.cpp": '#include "api/r.hpp"\n#include "drivers/sensor/s.hpp"\n',
    "tests/t.cpp": '#include "drivers/sim/world.hpp"\n#include "core/a.hpp"\n',
}


class Layering(unittest.TestCase):
    def expect_broken(self, why: str, files: dict[str, str]) -> None:
        found = check({**GOOD, **files})
        self.assertTrue(any(why in line for line in found), f"{why!r} not in {found}")

    def test_accepts_what_keeps_to_it(self):
        self.assertEqual(check(GOOD), [])

    def test_refuses_an_empty_tree(self):
        self.assertNotEqual(check({"README.md": "nothing"}), [])

    def test_core_includes_nothing_above_it(self):
        for header in ("drivers/sensor/s.hpp", "api/r.hpp", "server/wire.hpp", "tests/t.hpp"):
            self.expect_broken("core may include core", {"core/b.cpp": f'#include "{header}"\n'})

    def test_includes_in_angle_brackets_count_too(self):
        self.expect_broken("core may include core", {"core/b.cpp": "#  include <api/r.hpp>\n"})

    def test_siblings_included_by_bare_name_are_found(self):
        files = {"core/b.hpp": "#include <OpenNI.h>\n", "core/b.cpp": '#include "b.hpp"\n'}
        self.expect_broken("core/b.cpp -> core/b.hpp: sees OpenNI.h", files)

    def test_api_knows_no_driver(self):
        self.expect_broken("api may include api, core", {"api/b.cpp": '#include "drivers/sensor/s.hpp"\n'})

    def test_api_and_drivers_do_not_know_each_other_or_the_server(self):
        self.expect_broken("drivers may include drivers, core", {"drivers/b.cpp": '#include "api/r.hpp"\n'})
        self.expect_broken("api may include api, core", {"api/b.cpp": '#include "server/wire.hpp"\n'})

    def test_core_opens_no_socket(self):
        for header in ("boost/asio.hpp", "boost/asio/ip/tcp.hpp", "boost/beast.hpp", "sys/socket.h"):
            self.expect_broken("opens no socket", {"core/b.cpp": f"#include <{header}>\n"})

    def test_public_headers_of_core_show_own_types_alone(self):
        for header in ("pcl/point_cloud.h", "boost/json.hpp", "embree3/rtcore.h", "assimp/scene.h"):
            files = {"core/r/view.hpp": f"#include <{header}>\n", "server/b.cpp": '#include "core/r/view.hpp"\n'}
            self.expect_broken(f"core/r/view.hpp: shows {header} to server/b.cpp", files)

    def test_a_header_is_public_through_others_and_to_other_folders_of_core(self):
        files = {"core/r/view.hpp": '#include "core/r/scene.hpp"\n', "core/s/b.cpp": '#include "core/r/view.hpp"\n'}
        self.expect_broken("core/r/scene.hpp: shows embree3/rtcore.h to core/s/b.cpp", files)

    def test_tests_may_look_inside(self):
        self.assertEqual(check({**GOOD, "tests/core/b.cpp": '#include "core/r/scene.hpp"\n'}), [])

    def test_pcl_stays_in_the_shared_object_of_its_own(self):
        for file in ("api/b.cpp", "core/b.cpp", "core/paper/b.cpp", "tests/core/b.cpp"):
            self.expect_broken("PCL is fenced", {file: "#include <pcl/point_cloud.h>\n"})

    def test_daemons_know_no_database_server(self):
        for file in ("server/b.cpp", "fleet/exporter/b.cpp", "core/b.cpp"):
            self.expect_broken("libpq is fenced", {file: "#include <libpq-fe.h>\n"})
        self.expect_broken("server may include", {"server/b.cpp": '#include "fleet/collector/warehouse.hpp"\n'})
        self.expect_broken("libmosquitto is fenced", {"server/b.cpp": "#include <mosquitto.h>\n"})

    def test_the_collector_knows_no_cell(self):
        self.expect_broken("fleet/collector may include", {"fleet/collector/b.cpp": '#include "api/r.hpp"\n'})
        self.expect_broken("fleet/collector may include", {"fleet/collector/b.cpp": '#include "fleet/exporter/exporter.hpp"\n'})

    def test_the_simulator_shares_nothing_with_core(self):
        self.expect_broken("drivers/sim may include", {"drivers/sim/b.cpp": '#include "core/a.hpp"\n'})
        self.expect_broken("drivers/sim may include", {"drivers/sim/b.cpp": '#include "drivers/sensor/s.hpp"\n'})
        through = {"core/base/r.hpp": '#include "core/a.hpp"\n', "drivers/sim/b.cpp": '#include "core/base/r.hpp"\n'}
        self.expect_broken("shares nothing but error values", through)

    def test_no_translation_unit_sees_two_boosts(self):
        files = {"tests/b.cpp": '#include <pcl/point_cloud.h>\n#include "tests/h.hpp"\n',
                 "tests/h.hpp": "#include <boost/json.hpp>\n"}
        self.expect_broken("no translation unit may see PCL and", files)


if __name__ == "__main__":
    unittest.main()
