#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""Fails when `cmake --install` or cpack lay out something else than they should.

usage: package_layout.py BUILD_DIRECTORY
"""

import subprocess
import sys
import tempfile
from pathlib import Path

# Of a prefix. What is below share/doc is not listed here.
LAYOUT = {"bin/calibrd", "bin/calibrd-sensor", "lib/calibrd/libcalibrd_pcl.so", "lib/systemd/system/calibrd.service",
          "lib/sysusers.d/calibrd.conf", "lib/tmpfiles.d/calibrd.conf", "lib/udev/rules.d/60-calibrd.rules", "share/man/man8/calibrd.8.gz"}
PAGE = "share/calibrd/web/"
OPTIONAL = (PAGE,)
OF_THE_PAGE = {PAGE + "index.html", PAGE + "notices.txt"}  # where it is at all
DOCUMENTATION = {"README.md", "copyright", "changelog.gz", "docs/README.md", "docs/configuration.md", "examples/fanuc.toml"}
CONFIGURATION = "etc/calibrd/calibrd.toml"
DEPENDS = ("libopenni2-0", "libembree", "libpcl-filters", "libssl", "libsqlite3-0", "systemd")


def run(*words, **options) -> str:
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options)
    if done.returncode != 0:
        sys.exit(f"{words[0]} failed:\n{done.stdout}")
    return done.stdout


def layout_faults(what: str, files: set[str], prefix: str, configuration: str) -> list[str]:
    """What is missing, and what nobody asked for."""
    documentation = f"{prefix}share/doc/calibrd/"
    layout = LAYOUT | OF_THE_PAGE if any(file.startswith(prefix + PAGE) for file in files) else LAYOUT
    wanted = {prefix + file for file in layout} | {documentation + file for file in DOCUMENTATION} | {configuration}
    allowed = (documentation, *(prefix + folder for folder in OPTIONAL))
    return ([f"{what} lacks {file}" for file in sorted(wanted - files)] +
            [f"{what} has {file}, which nobody asked for" for file in sorted(files - wanted) if not file.startswith(allowed)])


def files_in(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def check_install(build: Path, folder: Path) -> list[str]:
    faults = []
    for prefix, configuration in (("usr/", CONFIGURATION), ("opt/calibrd/", f"opt/calibrd/{CONFIGURATION}")):
        root = folder / prefix.split("/", maxsplit=1)[0]
        words = ("env", f"DESTDIR={root}", "cmake", "--install", build, "--prefix", f"/{prefix}".rstrip("/"))
        run(*words)
        what = f"cmake --install --prefix /{prefix}"
        faults += layout_faults(what, files_in(root), prefix, configuration)
        unit = (root / prefix / "lib/systemd/system/calibrd.service").read_text()
        if f"ExecStart=/{prefix}bin/calibrd serve" not in unit:
            faults.append(f"{what}: the unit starts another program")
        (root / configuration).write_text("# mine\n")
        run(*words)
        if (root / configuration).read_text() != "# mine\n":
            faults.append(f"{what} overwrites the configuration")
    version = run(folder / "usr/usr/bin/calibrd", "--version")
    if "calibrd" not in version:
        faults.append("the installed program does not run")
    if run("readelf", "-d", folder / "usr/usr/bin/calibrd").count("RUNPATH"):
        faults.append("the installed program looks for libraries where it was built")
    return faults


def check_deb(build: Path, folder: Path) -> list[str]:
    run("cpack", "-G", "DEB", "--config", build / "CPackConfig.cmake", "-B", folder, cwd=build)
    deb = next(folder.glob("*.deb"))
    lines = [line.split(maxsplit=5) for line in run("dpkg-deb", "-c", deb).splitlines()]
    faults = layout_faults("the .deb", {line[5].removeprefix("./") for line in lines if line[0].startswith("-")}, "usr/", CONFIGURATION)
    faults += [f"the .deb: {line[5]} belongs to {line[1]}" for line in lines if line[1] != "root/root"]
    faults += [f"the .deb: others may write {line[5]}" for line in lines if "w" in line[0][4:]]
    control = folder / "control"
    run("dpkg-deb", "-e", deb, control)
    depends = next(line for line in (control / "control").read_text().splitlines() if line.startswith("Depends:"))
    faults += [f"the .deb does not depend on {library}" for library in DEPENDS if library not in depends]
    if (control / "conffiles").read_text() != f"/{CONFIGURATION}\n":
        faults.append("the .deb: the configuration is no conffile")
    for script in ("postinst", "prerm", "postrm"):
        run("sh", "-n", control / script)
    return faults


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    build = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory(prefix="calibrd-layout-") as folder:
        faults = check_install(build, Path(folder))
        (Path(folder) / "deb").mkdir()
        faults += check_deb(build, Path(folder) / "deb")
    print("\n".join(faults) if faults else "all of it is where it should be")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
