"""Runs web/check.mjs in the build folder's copy of web/, where cmake/build_front_end.py has installed the packages."""
import pathlib
import subprocess
import sys

work = pathlib.Path(sys.argv[1])
if not (work / "node_modules" / "typescript").is_dir():
    print("skipped: the packages of web/ are not installed (nodejs, npm or the network was missing during the build)")
    sys.exit(77)
sys.exit(subprocess.run(["node", "check.mjs"], cwd=work, check=False).returncode)
