"""Trains on two hosts: network namespaces with their own addresses and host names, joined by a virtual cable and a shared folder.

mpirun starts ranks on both through an agent instead of ssh. During training the cable is pulled: the job ends, skyquilt-mpirun restarts it
when the cable is back, and the result is bit-identical to an undisturbed run. Skipped where namespaces are not allowed.
"""
import os
import pathlib
import signal
import subprocess
import sys

from harness import expect, main, small_project, state_of, wait_for

ROOT = pathlib.Path(__file__).resolve().parents[2]
HOSTS = {"skyquilt-a": "10.231.77.1", "skyquilt-b": "10.231.77.2"}
TRAIN = ["--steps", "1000", "--set", "train.checkpoint_every_s=0.2", "--set", "context.checkpoint_every_s=0.2", "--set", "train.batch_samples=4096",
         "--set", "context.batch_samples=4096"]
# A lost host is noticed within seconds instead of minutes.
QUICK = ["--mca", "oob_tcp_keepalive_time", "2", "--mca", "oob_tcp_keepalive_intvl", "1", "--mca", "oob_tcp_keepalive_probes", "2"]
SKIPPED = 77


def ip(*words):
    return subprocess.run(["ip", *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def entering(host):
    return ["ip", "netns", "exec", host, "unshare", "--uts", "sh", "-c", f'hostname {host} && exec "$@"', "sh"]


def make_hosts():
    """Returns why the hosts cannot be made; empty on success."""
    remove_hosts()
    for host in HOSTS:
        done = ip("netns", "add", host)
        if done.returncode != 0:
            return done.stdout.strip()
    names = list(HOSTS)
    commands = [["link", "add", "cable0", "netns", names[0], "type", "veth", "peer", "name", "cable0", "netns", names[1]]]
    for host, address in HOSTS.items():
        commands += [["-n", host, "addr", "add", f"{address}/24", "dev", "cable0"], ["-n", host, "link", "set", "cable0", "up"],
                     ["-n", host, "link", "set", "lo", "up"]]
    for command in commands:
        done = ip(*command)
        if done.returncode != 0:
            return done.stdout.strip()
    done = subprocess.run(entering(names[0]) + ["hostname"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return "" if done.stdout.strip() == names[0] else done.stdout.strip()


def remove_hosts():
    for host in HOSTS:
        found = ip("netns", "pids", host)
        for pid in found.stdout.split() if found.returncode == 0 else []:
            try:
                os.kill(int(pid), signal.SIGKILL)
            except (ProcessLookupError, ValueError):
                pass
        ip("netns", "del", host)


def agent_in(folder):
    """Writes the script that mpirun calls instead of ssh: AGENT [options] HOST COMMAND."""
    cases = "\n".join(f"  {address}|{host}) host={host} ;;" for host, address in HOSTS.items())
    script = folder / "agent"
    script.write_text("#!/bin/sh\nwhile [ \"${1#-}\" != \"$1\" ]; do shift; done\ncase \"$1\" in\n" + cases + "\n  *) exit 255 ;;\nesac\nshift\n"
                      "exec ip netns exec \"$host\" unshare --uts sh -c 'hostname \"$0\" && exec sh -c \"$1\"' \"$host\" \"$*\"\n")
    script.chmod(0o755)
    return script


def test(skyquilt, folder):
    first = list(HOSTS)[0]
    agent = agent_in(folder)

    def start(project, name):
        small_project(skyquilt, project)
        words = entering(first) + [str(ROOT / "scripts" / "skyquilt-mpirun"), "--restarts", "5", "--wait", "3", "-n", "3", "--host",
                                   f"{HOSTS[first]}:2,{HOSTS[list(HOSTS)[1]]}:1", "--mca", "plm_rsh_agent", str(agent), "--mca", "btl", "tcp,self", "--mca",
                                   "btl_tcp_if_include", "cable0", "--mca", "oob_tcp_if_include", "cable0", *QUICK, skyquilt.program, "train", str(project),
                                   *TRAIN]
        log = open(folder / f"{name}.log", "w")
        return subprocess.Popen(words, env=skyquilt.environment, stdout=log, stderr=subprocess.STDOUT, start_new_session=True), folder / f"{name}.log"

    def finish(process, log):
        status = process.wait(timeout=600)
        expect(status == 0, f"ended with {status}:\n{log.read_text()}")

    whole = folder / "whole"
    process, log = start(whole, "whole")
    finish(process, log)

    cut = folder / "cut"
    process, log = start(cut, "cut")
    process.stdout = open(log)  # for wait_for's message
    wait_for(lambda: len(list(cut.glob("checkpoints/block_*.h5"))) == 2, "first checkpoints of both blocks", process)
    expect(ip("-n", first, "link", "set", "cable0", "down").returncode == 0, "the cable could not be pulled")
    wait_for(lambda: "new start" in log.read_text(), "new start after the cable was pulled", process, seconds=120)
    ip("-n", first, "link", "set", "cable0", "up")
    finish(process, log)
    text = log.read_text()
    expect("new start 1 of 5" in text, text)
    expect(state_of(skyquilt, cut) == state_of(skyquilt, whole), "the result differs from that of the undisturbed run")


if __name__ == "__main__":
    reason = make_hosts()
    if reason:
        remove_hosts()
        print(f"skipped: this system does not allow network namespaces ({reason})")
        sys.exit(SKIPPED)
    try:
        main(test)
    finally:
        remove_hosts()
