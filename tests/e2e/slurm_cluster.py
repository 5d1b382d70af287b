"""A Slurm cluster of several nodes on one machine, without systemd: munged, slurmctld and one slurmd for each node.

Debian's slurmd is built for several on one host, but MPI takes two nodes of one host name for one machine. So every node has namespaces of its own: a
network with its own address, a host name, processes that all end with the first of them, and a folder for temporary files that is empty after every
start. Must be called by root in namespaces of its own (scripts/slurm_on_one_machine.sh): it renames the host and covers /run and /etc/hosts.
"""
import os
import pathlib
import signal
import subprocess
import time

from harness import Failure

ADDRESS = "10.231.78."
CONTROL = "skyquilt-control"

# Nodes have as many CPUs as the job asks for, whatever the machine has. A node is missed after 20 s instead of 300, and a job that was queued again
# may start after 15 s instead of 120: Slurm waits for as long as the credentials of the job's last start are valid.
CONFIG = """ClusterName=skyquilt
SlurmctldHost={control}({address}1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=15
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd_%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd_%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
MpiDefault=none
ReturnToService=2
SlurmdTimeout=20
MessageTimeout=5
"""


def run(*words, check=True, **more):
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)
    if check and done.returncode != 0:
        raise Failure(f"'{' '.join(str(word) for word in words)}' ended with {done.returncode}:\n{done.stdout}")
    return done.stdout.strip()


class Cluster:
    """`cpus`: of each node. Everything it writes is in `folder`."""

    def __init__(self, folder, nodes, cpus):
        os.environ["PATH"] += ":/usr/sbin:/sbin"
        self.folder = folder
        self.addresses = {name: ADDRESS + str(number) for number, name in enumerate(nodes, 11)}
        self.processes = {}
        for name in ("state", "spool", "munge", "tmp"):
            (folder / name).mkdir(parents=True, mode=0o755)
        self.config = folder / "slurm.conf"
        self.config.write_text(
            CONFIG.format(folder=folder, control=CONTROL, address=ADDRESS) +
            "".join(f"NodeName={name} NodeAddr={address} CPUs={cpus}\n" for name, address in self.addresses.items()) +
            "PartitionName=all Nodes=ALL Default=YES State=UP\n")
        # This plugin looks for no mounted cgroups until a limit asks for one.
        (folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        os.environ["SLURM_CONF"] = str(self.config)

    def start(self):
        hosts = self.folder / "hosts"
        hosts.write_text("".join(f"{address} {name}\n" for name, address in
                                 [("localhost", "127.0.0.1"), (CONTROL, ADDRESS + "1"), *self.addresses.items()]))
        run("mount", "--make-rprivate", "/")
        run("mount", "--bind", hosts, "/etc/hosts")
        run("mount", "-t", "tmpfs", "tmpfs", "/run")  # names of the networks
        run("hostname", CONTROL)
        run("ip", "link", "set", "lo", "up")
        run("ip", "link", "add", "cluster", "type", "bridge")
        run("ip", "addr", "add", ADDRESS + "1/24", "dev", "cluster")
        run("ip", "link", "set", "cluster", "up")
        key, socket = self.folder / "munge" / "key", self.folder / "munge" / "socket"
        run("mungekey", "--create", "--keyfile", key)
        # --force: a folder below /tmp is writable by all, which munged would only warn of otherwise.
        self.spawn("munged", ["munged", "--foreground", "--force", f"--key-file={key}", f"--socket={socket}", f"--pid-file={self.folder}/munge/pid",
                              f"--seed-file={self.folder}/munge/seed"])
        self.until(socket.exists, "munged")
        self.spawn("slurmctld", ["slurmctld", "-D"])
        self.until(lambda: "UP" in run("scontrol", "ping", check=False), "slurmctld")
        for name in self.addresses:
            self.start_node(name)

    def spawn(self, name, words):
        with open(self.folder / f"{name}.out", "a") as out:
            self.processes[name] = subprocess.Popen([str(word) for word in words], stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)

    def until(self, condition, what, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            process = self.processes.get(what)
            if time.monotonic() > end or (process and process.poll() is not None):
                raise Failure(f"{what} does not run; see {self.folder}/{what}.log and .out:\n" + self.told_by(what))
            time.sleep(0.2)

    def told_by(self, name):
        files = [self.folder / f"{name}.out", self.folder / f"{name}.log", self.folder / f"slurmd_{name}.log"]
        return "".join(f"{path.name}: {path.read_text(errors='replace')[-2000:]}\n" for path in files if path.exists())

    def start_node(self, name):
        run("ip", "netns", "add", name)
        run("ip", "link", "add", f"to-{name}", "type", "veth", "peer", "name", "eth0", "netns", name)
        run("ip", "link", "set", f"to-{name}", "master", "cluster", "up")
        for words in (["addr", "add", self.addresses[name] + "/24", "dev", "eth0"], ["link", "set", "eth0", "up"], ["link", "set", "lo", "up"]):
            run("ip", "-n", name, *words)
        tmp = self.folder / "tmp"
        # The shell is the node's first process: with it end all others. It also takes in what ended processes leave.
        starting = (f"hostname {name} && mount -t tmpfs tmpfs {tmp} && mount -t tmpfs tmpfs /dev/shm && "
                    f"{{ slurmd -D -N {name} & while kill -0 $! 2>/dev/null; do wait; done; }}")
        self.spawn(name, ["ip", "netns", "exec", name, "unshare", "--uts", "--ipc", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc",
                          "bash", "-c", starting])
        self.until(lambda: self.state(name) in ("IDLE", "MIXED", "ALLOCATED"), name)

    def state(self, name):
        found = run("sinfo", "-h", "-N", "-n", name, "-o", "%T", check=False).upper()
        return found

    def take_away(self, name):
        """As if its plug were pulled: its processes end at once, and nobody answers at its address."""
        run("ip", "link", "set", f"to-{name}", "down")
        self.processes[name].send_signal(signal.SIGKILL)
        self.processes.pop(name).wait()
        run("ip", "link", "del", f"to-{name}")
        run("ip", "netns", "del", name)

    def stop(self):
        for process in self.processes.values():
            process.terminate()
        for process in self.processes.values():
            try:
                process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                process.kill()

    def job(self, number):
        """What Slurm knows of a job: JobState, Restarts, Reason and others."""
        words = run("scontrol", "-o", "show", "job", number, check=False).split()
        return dict(word.split("=", 1) for word in words if "=" in word)


def read(path):
    return pathlib.Path(path).read_text(errors="replace") if pathlib.Path(path).exists() else ""
