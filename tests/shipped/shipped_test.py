#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Shows that the checks of the shipped binaries find what they are there to find."""

import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from boost_symbols import check, displaced_by, sort_objects, symbols_of, weak_boost_symbols
from boost_bindings import crossings
from linked_libraries import complaints, shipped_binaries

DEPS = """a.o: #deps 2, deps mtime 1 (VALID)
    ../a.cpp
    /usr/include/boost/config.hpp

b.o: #deps 2, deps mtime 1 (VALID)
    /src/.deps/boost/usr/include/boost/json.hpp
    /usr/include/pcl/point_cloud.h

c.o: #deps 2, deps mtime 1 (VALID)
    /usr/include/boost/config.hpp
    ../.deps/boost/usr/include/boost/json.hpp

d.o: #deps 1, deps mtime 1 (VALID)
    ../d.cpp

e.o: #deps 1, deps mtime 1 (VALID)
    ../../usr/include/boost/config.hpp

pch.hxx.gch: #deps 1, deps mtime 1 (VALID)
    ../.deps/boost/usr/include/boost/json.hpp

f.o: #deps 2, deps mtime 1 (VALID)
    /src/build/pch.hxx.gch
    /usr/include/boost/config.hpp

g.o: #deps 1, deps mtime 1 (VALID)
    pch.hxx.gch
"""

DEPS_OF_TWO = ("theirs.o: #deps 1\\n    /usr/include/boost/version.hpp\\n\\n"
               "ours.o: #deps 1\\n    /src/.deps/boost/usr/include/boost/version.hpp\\n\\n")
VERSION = "_ZN5boost7versionEv"


def gcc(folder: str, *arguments: str) -> None:
    subprocess.run(["g++", "-fPIC", *arguments], cwd=folder, check=True)


def compile_boost_user(folder: str, name: str, version: int) -> None:
    """An object with a function `name` that calls an inline function of namespace boost."""
    Path(folder, f"{name}.cpp").write_text(f"namespace boost {{ inline int version() {{ return {version}; }} }}\n"
                                           f"int {name}() {{ return boost::version(); }}\n")
    gcc(folder, "-c", f"{name}.cpp")


class LinkedLibraries(unittest.TestCase):
    def test_accepts_what_a_daemon_needs(self):
        self.assertEqual(complaints("calibrd", "\tlibpcl_common.so.1.13 => /lib/libpcl_common.so.1.13 (0x1)\n"), [])

    def test_finds_qt_vtk_and_heavy_parts_of_pcl(self):
        for name in ("libQt5Core.so.5", "libvtkCommonCore-9.1.so.1", "libpcl_io.so.1.13", "libpcl_features.so.1.13"):
            self.assertEqual(complaints("calibrd", f"\t{name} => /lib/{name} (0x1)\n"), [f"calibrd: needs {name}"])

    def test_finds_a_missing_library(self):
        self.assertEqual(len(complaints("calibrd", "\tliba.so => not found\n")), 1)

    def test_programs_are_shipped_tests_are_not(self):
        with tempfile.TemporaryDirectory() as folder:
            for place in ("bin", "tests"):
                Path(folder, place).mkdir()
                shutil.copy("/bin/true", Path(folder, place, "program"))
            self.assertEqual([p.parent.name for p in shipped_binaries(Path(folder))], ["bin"])


class BoostSymbols(unittest.TestCase):
    def test_sorts_objects_by_the_boost_they_saw(self):
        use = sort_objects(DEPS, Path("/src/build"))
        self.assertEqual((use.system, use.private, use.both), (["a.o", "e.o"], ["b.o", "g.o"], ["c.o", "f.o"]))

    def test_reads_weak_symbols_of_boost_alone(self):
        nm = "00 W _ZN5boost1fEv\n00 V _ZTIN5boost1AE\n00 u _ZN5boost1gE\n00 T _ZN5boost1hEv\n00 W _ZN3stdv\n"
        self.assertEqual(weak_boost_symbols(nm), {"_ZN5boost1fEv", "_ZTIN5boost1AE", "_ZN5boost1gE"})

    def test_finds_a_weak_symbol_that_two_objects_share(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, version in (("a", 74), ("b", 81)):
                compile_boost_user(folder, name, version)
            shared = symbols_of(["a.o"], Path(folder)) & symbols_of(["b.o"], Path(folder))
            self.assertEqual(shared, {VERSION})

    def test_finds_a_program_that_puts_its_boost_in_the_place_of_a_library_s(self):
        with tempfile.TemporaryDirectory() as folder:
            compile_boost_user(folder, "theirs", 74)
            compile_boost_user(folder, "ours", 81)
            gcc(folder, "-shared", "theirs.o", "-o", "libtheirs.so")
            subprocess.run(["ar", "rcs", "libours.a", "ours.o"], cwd=folder, check=True)
            Path(folder, "main.cpp").write_text("int theirs(); int ours(); int main() { return theirs() + ours(); }")
            link = ("main.cpp", "-L.", "-lours", "-ltheirs", f"-Wl,-rpath,{folder}")
            gcc(folder, *link, "-o", "open")
            gcc(folder, *link, "-o", "closed", "-Wl,--exclude-libs,ALL")
            self.assertEqual(displaced_by(Path(folder, "open")), {VERSION})
            self.assertEqual(displaced_by(Path(folder, "closed")), set())

    def test_finds_a_program_that_puts_its_boost_in_the_place_of_a_module_s(self):
        with tempfile.TemporaryDirectory() as folder:
            compile_boost_user(folder, "theirs", 74)
            compile_boost_user(folder, "ours", 81)
            Path(folder, "module.cpp").write_text("int theirs(); int module() { return theirs(); }")
            Path(folder, "main.cpp").write_text("int ours(); int main() { return ours(); }")
            gcc(folder, "-shared", "theirs.o", "-o", "libtheirs.so")
            gcc(folder, "-shared", "module.cpp", "-L.", "-ltheirs", f"-Wl,-rpath,{folder}", "-o", "module.so")
            gcc(folder, "main.cpp", "ours.o", "-rdynamic", "-o", "open")
            gcc(folder, "main.cpp", "ours.o", "-o", "closed")
            for program, found in (("open", {VERSION}), ("closed", set())):
                self.assertEqual(displaced_by(Path(folder, program), [Path(folder, "module.so")]), found)

    def test_a_module_is_linked_apart_and_exports_none(self):
        with tempfile.TemporaryDirectory() as folder:
            build = Path(folder)
            Path(folder, "lib/calibrd").mkdir(parents=True)
            for name, version in (("theirs", 74), ("ours", 81)):
                compile_boost_user(folder, name, version)
            Path(folder, "exports.map").write_text("{ global: *theirs*; local: *; };")
            script = Path(folder, "ninja")  # what it would say of such a build
            script.write_text(f"""#!/bin/sh
case $2 in
deps) printf '{DEPS_OF_TWO}' ;;
query) printf '%s:\\n  input: LINK\\n    theirs.o\\n' "$3" ;;
esac
""")
            script.chmod(0o755)
            gcc(folder, "-shared", "theirs.o", "-Wl,--version-script=exports.map", "-o", "lib/calibrd/module.so")
            self.assertEqual(check(build, str(script))[0], [])
            gcc(folder, "-shared", "theirs.o", "-o", "lib/calibrd/module.so")
            self.assertEqual(check(build, str(script))[0], ["module.so exports: boost::version()"])
            Path(folder, "lib/calibrd/module.so").unlink()
            self.assertEqual(check(build, str(script))[0], ["weak on both sides: boost::version()"])


class BoostBindings(unittest.TestCase):
    def test_finds_symbols_of_boost_bound_between_a_module_s_libraries_and_the_rest(self):
        line = "  7: binding file {} [0] to {} [0]: normal symbol `{}' [V1]\n"
        pcl, calibrd, libc = "/usr/lib/libpcl_common.so.1.13", "build/bin/calibrd", "/lib/libc.so.6"
        log = "".join((line.format(pcl, pcl, VERSION), line.format(pcl, libc, "memcpy"), line.format(calibrd, libc, "open")))
        self.assertEqual(crossings(log), [])
        for pair in ((pcl, calibrd), (calibrd, pcl)):
            self.assertEqual(len(crossings(log + line.format(*pair, VERSION))), 1)


if __name__ == "__main__":
    unittest.main()
