"""The Debian packages of a build: made, unpacked into an empty folder, looked at, and used from there with an empty environment."""
import os
import pathlib
import shutil
import subprocess
import sys

from harness import expect, main

SKIPPED = 77
NEEDED = ("cpack", "dpkg-deb", "dpkg-shlibdeps", "file", "readelf")
# What a user has, and nothing of the build.
ENVIRONMENT = {"PATH": "/usr/local/bin:/usr/bin:/bin"}


def output(*command, cwd, environment=None):
    done = subprocess.run([str(word) for word in command], cwd=cwd, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", timeout=600)
    expect(done.returncode == 0, f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}")
    return done.stdout


def names(field):
    """Names of packages in a field such as Depends, without their versions."""
    return [entry.split()[0] for entry in field.split(",")]


def module(package, root, version, away, built_in, field):
    """The Python module alone, without the program: it is imported from an empty root, and answers."""
    expect(field("Description", package).splitlines()[0].endswith("Python module"), field("Description", package))
    depends = names(field("Depends", package))
    for wanted in ("python3", "python3-numpy", "libhdf5", "libgdal", "libopencv-core"):
        expect(any(name.startswith(wanted) for name in depends), f"{wanted} is not among {depends} of the module")
    output("dpkg-deb", "--extract", package, root, cwd=away)
    modules = root / "usr/lib/python3/dist-packages"
    extensions = list((modules / "skyquilt").glob("_skyquilt*.so"))
    expect(len(extensions) == 1, f"the module's package has {extensions}")
    expect(sorted(path.name for path in (root / "usr").rglob("*") if path.is_file() and path.suffix == "" and "doc" not in path.parts) == [],
           "the module's package has programs")
    dynamic = output("readelf", "--dynamic", extensions[0], cwd=away)
    expect("RUNPATH" not in dynamic and "RPATH" not in dynamic, dynamic)
    for place in built_in:
        expect(os.fsencode(place) not in extensions[0].read_bytes(), f"the module names {place}")
    for name in ("py.typed", "_skyquilt.pyi"):
        expect((modules / "skyquilt" / name).exists(), f"{name} is missing")
    expect((root / "usr/share/doc/python3-skyquilt/copyright").stat().st_size > 0, "the module's copyright file is empty")
    says = output("/usr/bin/python3", "-B", "-c", "import skyquilt, numpy as np; print(skyquilt.__version__, skyquilt.__file__, "
                  "skyquilt.psnr(np.zeros((12, 12)), np.full((12, 12), 0.1)))", cwd=away, environment={**ENVIRONMENT, "PYTHONPATH": str(modules)}).split()
    expect(says[0] == version and says[1].startswith(str(root)) and abs(float(says[2]) - 20.0) < 1e-3, f"the installed module says {says}")


def test(_, folder):
    build = pathlib.Path(sys.argv[1]).resolve()
    source = pathlib.Path(__file__).resolve().parents[2]
    # xz would take most of the test's time, and the contents are the same.
    output("cpack", "--config", build / "CPackConfig.cmake", "-G", "DEB", "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip", "-B", folder / "made", cwd=folder)
    packages = {path.name.split("_")[0]: path for path in (folder / "made").glob("*.deb")}
    has_module = (build / "python" / "skyquilt").is_dir()
    expect(sorted(packages) == (["python3-skyquilt"] if has_module else []) + ["skyquilt"], f"cpack made {packages}")
    package = packages["skyquilt"]

    def field(name, of=package):
        return output("dpkg-deb", "--field", of, name, cwd=folder).strip()

    version = field("Version")
    expect(package.name == f"skyquilt_{version}_{field('Architecture')}.deb", package.name)
    expect(field("Description").splitlines()[0].endswith("radiance field, on CPUs"), field("Description"))
    depends = names(field("Depends"))
    for wanted in ("openmpi-bin", "libopenmpi", "libhdf5", "libgdal", "libopencv-core", "libexiv2", "libembree"):
        expect(any(name.startswith(wanted) for name in depends), f"{wanted} is not among {depends}")
    recommends = names(field("Recommends"))
    expect(recommends == ["colmap", "ffmpeg"], f"recommends {recommends}")

    root = folder / "root"
    output("dpkg-deb", "--extract", package, root, cwd=folder)
    documents = root / "usr/share/doc/skyquilt"
    for path in ("copyright", "LICENSE", "README.md", "docs/licences.md", "docs/commands.md", "examples/configs/fast.toml", "examples/configs/methods/nerf.toml", "examples/skyquilt.slurm"):
        expect((documents / path).stat().st_size > 0, f"{path} is empty")
    programs = sorted(path.name for path in (root / "usr/bin").iterdir())
    expect(programs == ["skyquilt", "skyquilt-bench", "skyquilt-mpirun"], f"programs: {programs}")
    expect((documents / "copyright").read_text().startswith("Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/"), "copyright")

    for program in (root / "usr/bin/skyquilt-bench", root / "usr/bin/skyquilt"):
        dynamic = output("readelf", "--dynamic", program, cwd=folder)
        expect("RUNPATH" not in dynamic and "RPATH" not in dynamic, dynamic)
        expect(".symtab" not in output("readelf", "--sections", "--wide", program, cwd=folder), f"{program} is not stripped")
        for place in (source, build):
            expect(os.fsencode(place) not in program.read_bytes(), f"{program} names {place}")

    # From here on nothing of the build is used.
    away = folder / "away"
    away.mkdir()
    libraries = output("ldd", program, cwd=away, environment=ENVIRONMENT)
    expect("not found" not in libraries, libraries)
    expect(output(program, "--version", cwd=away, environment=ENVIRONMENT).split() == ["skyquilt", version], "another version than the package's")
    defaults = output(program, "--config", "fast", "info", "--defaults", cwd=away, environment=ENVIRONMENT)
    expect("max_log2_table_size" in defaults, defaults)
    output(program, "simulate", "hamlet", "-o", "survey", "--set", "simulate.image_width=96", cwd=away, environment=ENVIRONMENT)
    output(program, "info", "survey", cwd=away, environment=ENVIRONMENT)
    engine = root / "usr/share/skyquilt/odm"
    expect((engine / "VERSION").read_text().strip() == version and (engine / "ENGINE").read_text().strip() == "skyquilt", "VERSION and ENGINE")
    expect(output(engine / "run.sh", "--version", cwd=engine, environment=ENVIRONMENT).split() == ["skyquilt", version], "run.sh starts another program")
    expect("--orthophoto-resolution" in output("python3", "-B", "-c", "import config; config.config(['-h'])", cwd=engine / "opendm",
                                               environment=ENVIRONMENT), "config.py lists no options")
    if has_module:
        module(packages["python3-skyquilt"], folder / "python_root", version, away, (source, build), field)
    help_text = subprocess.run([root / "usr/bin/skyquilt-mpirun", "--help"], env=ENVIRONMENT, stderr=subprocess.PIPE, text=True)
    expect("skyquilt-mpirun [--restarts N]" in help_text.stderr, help_text.stderr)


if __name__ == "__main__":
    missing = [program for program in NEEDED if shutil.which(program) is None]
    if missing:
        print(f"skipped: not installed: {', '.join(missing)}")
        sys.exit(SKIPPED)
    main(test)
