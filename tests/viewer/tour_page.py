"""The page of exported tours in a real browser, over a small synthetic tour: tour_page.py BUILD/web OUT"""
import pathlib
import shutil
import subprocess
import sys

work, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
if not (work / "dist_test" / "tour.js").is_file() or not (work / "node_modules" / "playwright-core").is_dir():
    print("skipped: the front end was not built (nodejs, npm or the network was missing)")
    sys.exit(77)
if not shutil.which("chromium"):
    print("skipped: chromium is not installed")
    sys.exit(77)
shutil.rmtree(out, ignore_errors=True)
out.mkdir(parents=True)
sys.exit(subprocess.run(["node", "test/page/offline_page.mjs", "dist_test", str(out.resolve())], cwd=work, check=False).returncode)
