#!/usr/bin/env python3
"""A sweep through a real Slurm of one node, started here on loopback with all its state in a folder of its own. Skipped
where Slurm and munge are not installed (apt-get install slurm-wlm munge) or by anybody but root."""
import csv
import os
import pwd
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = os.path.abspath(sys.argv.pop(1))
SKIPPED = 77
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "sinfo")

SCENE = """name: silo
domain: {width: 40, height: 40}
grid: {cells_x: 16}
materials: {sand: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4}}
fill: [{material: sand, box: {x: [0, 40], y: [0, 30]}}]
orifices: [{wall: bottom, centre: 20, width: 20}]
time: {end: 1}
"""

CONFIGURATION = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
MinJobAge=10
KillWait=1
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


class Cluster:
    def __init__(self):
        self.folder = tempfile.mkdtemp()
        self.daemons = []
        os.chmod(self.folder, 0o755)
        munge, host = pwd.getpwnam("munge"), os.uname().nodename.split(".")[0]
        for name in ("munge", "state", "spool"):
            os.mkdir(f"{self.folder}/{name}", 0o755)
        with open(f"{self.folder}/munge/key", "wb") as file:
            file.write(os.urandom(1024))
        os.chmod(f"{self.folder}/munge/key", 0o400)
        for name in ("munge", "munge/key"):
            os.chown(f"{self.folder}/{name}", munge.pw_uid, munge.pw_gid)
        with open(f"{self.folder}/slurm.conf", "w") as file:
            file.write(CONFIGURATION.format(folder=self.folder, host=host, cpus=os.cpu_count()))
        os.environ["SLURM_CONF"] = f"{self.folder}/slurm.conf"
        at = f"{self.folder}/munge/"
        self.start("munged", "--foreground", "--force", f"--socket={at}socket", f"--key-file={at}key",
                   f"--pid-file={at}pid", f"--log-file={at}log", f"--seed-file={at}seed", user=munge)
        self.wait_for(lambda: os.path.exists(at + "socket"), "munged")
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        self.wait_for(lambda: subprocess.run(["sinfo", "--noheader", "--format=%T"], capture_output=True,
                                             text=True).stdout.strip() == "idle", "an idle node")

    def start(self, name, *arguments, user=None):
        with open(f"{self.folder}/{name}.log", "w") as log:
            extra = {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []} if user else {}
            self.daemons.append(subprocess.Popen([shutil.which(name), *arguments], stdout=log, stderr=log, **extra))

    def wait_for(self, condition, what):
        for _ in range(300):
            if condition():
                return
            time.sleep(0.1)
        for name in ("munged", "slurmctld", "slurmd"):
            with open(f"{self.folder}/{name}.log") as log:
                print(f"{name}: {log.read()[-1500:]}", file=sys.stderr)
        raise RuntimeError(f"no {what}")

    def stop(self):
        for daemon in reversed(self.daemons):
            daemon.terminate()
            daemon.wait(30)
        shutil.rmtree(self.folder)


class SlurmSweep(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cluster = Cluster()
        cls.addClassCleanup(cls.cluster.stop)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        with open(self.path("scene.yaml"), "w") as file:
            file.write(SCENE)

    def path(self, name):
        return os.path.join(self.folder, name)

    def study(self, *lines):
        with open(self.path("study.yaml"), "w") as file:
            file.write("\n".join(["name: widths", "scene: scene.yaml", *lines]) + "\n")

    def command(self, out, executor):
        return [PROGRAM, "sweep", "study.yaml", "--out", out, "--executor", executor]

    def sweep(self, out, executor):
        return subprocess.run(self.command(out, executor), cwd=self.folder, capture_output=True, text=True, timeout=300)

    def table(self, out):
        """The bytes of the table, without those of the times."""
        with open(self.path(f"{out}/results.csv"), newline="") as file:
            rows = list(csv.reader(file))
        times = rows[0].index("wall_seconds")
        return "\n".join(",".join(row[:times] + row[times + 1:]) for row in rows)

    def jobs(self, out):
        with open(self.path(f"{out}/slurm/jobs.csv")) as file:
            return [row["job"] for row in csv.DictReader(file)]

    def tasks(self):
        return subprocess.run(["squeue", "--noheader", "--array", "--format=%F_%K %t"], capture_output=True,
                              text=True).stdout.split("\n")[:-1]

    def wait_for(self, condition):
        for _ in range(600):
            if condition():
                return
            time.sleep(0.1)
        self.fail("waited for nothing")

    def test_the_table_is_that_of_local_runs(self):
        # Every other run diverges.
        self.study("axes: {orifices.0.width: [15, 20, 30], hard: [0, 1]}", "set:",
                   "  accuracy.max_iterations: 200 - 199*hard", "  accuracy.backup_every: 16 - 16*hard",
                   "  accuracy.pressure_tolerance: 1e-6*(1 - hard) + 1e-14*hard", "  time.dt_max: 0.05 + 4.95*hard")
        local = self.sweep("local", "local")
        self.assertEqual(local.returncode, 0, local.stderr)
        remote = self.sweep("remote", "slurm")
        self.assertEqual(remote.returncode, 0, remote.stderr)
        self.assertIn("diverged", self.table("local"))
        self.assertEqual(self.table("remote"), self.table("local"))
        self.assertEqual(len(self.jobs("remote")), 1)
        again = self.sweep("remote", "slurm")
        self.assertEqual((again.returncode, len(self.jobs("remote"))), (0, 1), again.stderr)

    def test_it_outlives_its_shell_and_tries_again_what_was_cancelled(self):
        self.study("axes: {orifices.0.width: [15, 20, 30], time.end: [30, 31]}", "set: {time.dt_max: '0.002'}")
        local = self.sweep("local", "local")
        self.assertEqual(local.returncode, 0, local.stderr)
        first = subprocess.Popen(self.command("remote", "slurm"), cwd=self.folder, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, start_new_session=True)
        self.wait_for(lambda: any(" R" in task for task in self.tasks()))
        os.killpg(first.pid, signal.SIGKILL)
        first.communicate()
        self.assertTrue(self.tasks())  # they go on
        other = self.sweep("remote", "local")
        self.assertEqual(other.returncode, 2)
        self.assertIn("Slurm is at work in it (job ", other.stderr)

        second = subprocess.Popen(self.command("remote", "slurm"), cwd=self.folder, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True)
        second.stdout.readline()
        pending = self.tasks()[-1].split()[0]
        subprocess.run(["scancel", pending], check=True)
        out, err = second.communicate(timeout=300)
        self.assertEqual(second.returncode, 1, out + err)
        self.assertIn("1 of 6 runs were ended by Slurm", err)
        self.assertEqual(len(self.jobs("remote")), 1)

        third = self.sweep("remote", "slurm")
        self.assertEqual(third.returncode, 0, third.stderr)
        self.assertEqual(len(self.jobs("remote")), 2)
        self.assertEqual(self.table("remote"), self.table("local"))

    def test_an_interrupt_leaves_the_job_at_work(self):
        self.study("axes: {orifices.0.width: [15, 20], time.end: [10, 11]}", "set: {time.dt_max: '0.002'}")
        process = subprocess.Popen(self.command("remote", "slurm"), cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
        if process.returncode == 130:  # else it was done before
            self.assertIn("Slurm works on: scancel ", out)
        again = self.sweep("remote", "slurm")
        self.assertEqual((again.returncode, len(self.jobs("remote"))), (0, 1), err + again.stderr)


if __name__ == "__main__":
    missing = [name for name in NEEDED if not shutil.which(name)]
    if missing or os.getuid() != 0:
        print("skipped: " + (f"no {', '.join(missing)} here" if missing else "only root can start a Slurm"))
        sys.exit(SKIPPED)
    unittest.main()
