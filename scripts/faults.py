#!/usr/bin/python3
"""Tries faults on real runs, says how each ended, and fills the table of docs/reliability.md.

    scripts/faults.py PROGRAM [--kills 50] [--thin 1] [--only WORD] [--write]

Needs python3-h5py; root for small and read-only disks, strace, faketime for some: what cannot be tried is said.
Exit status 1 if a fault ended other than it should.
"""
import argparse
import csv
import glob
import itertools
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

SCENE = """name: faults
domain: {width: 150, height: 150}
grid: {cells_x: 32}
materials: {sand: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4}, dye: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4}}
fill:
  - {material: sand, box: {x: [0, 150], y: [0, 100]}}
  - {material: dye, box: {x: [0, 150], y: [50, 100]}}
orifices: [{wall: bottom, centre: 75, width: 37.5}]
physics: {nonlocal: {A: 0.5}, dilatancy: {phi_g: 0.2}}
time: {end: 1e6, max_steps: 800}
output: {series_every: 0.1, fields_every: 0.1, snapshots_every: 0, fields: [speed, tracer], checkpoint_minutes: 0.005}
"""
STEPS = 800
CHECKPOINT_SECONDS = 0.3
FAULTS = []


class Skip(Exception):
    """The fault cannot be tried here."""


def fault(title, expected):
    def keep(function):
        FAULTS.append((title, expected, function))
        return function
    return keep


def check(holds, words):
    if not holds:
        raise AssertionError(words)


class Bench:
    """A folder for runs, and a run without a fault to compare with."""

    def __init__(self, program, kills, thin):
        self.program, self.kills, self.thin = os.path.abspath(program), kills, thin
        self.folder = tempfile.mkdtemp(prefix="faults_")
        self.random = random.Random(8)
        self.mounts = []
        with open(self.path("scene.yaml"), "w") as file:
            file.write(SCENE)
        result = self.run("whole")
        check(result.returncode == 0, result.stderr)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def command(self, out, *arguments, scene="scene.yaml"):
        return [self.program, "run", self.path(scene), "--out", self.path(out), "--quiet", "--threads", "1", *arguments]

    def run(self, out, *arguments, before=(), env=None, limit=None):
        set_limit = (lambda: resource.setrlimit(*limit)) if limit else None
        return subprocess.run([*before, *self.command(out, *arguments)], cwd=self.folder, capture_output=True, text=True,
                              timeout=900, env={**os.environ, **(env or {})}, preexec_fn=set_limit)

    def start(self, out, *arguments, env=None):
        """A run that has told something."""
        process = subprocess.Popen(self.command(out, *arguments), cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True, env={**os.environ, **(env or {})},
                                   preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL))  # under nohup too
        for _ in range(6000):
            if process.poll() is not None or len(self.rows(out)) > 2:
                return process
            time.sleep(0.01)
        raise AssertionError("the run tells nothing")

    def rows(self, out):
        """Whole rows of series.csv, without the column of wall times."""
        try:
            with open(self.path(out, "series.csv")) as file:
                text = file.read()
        except FileNotFoundError:
            return []
        rows = [line.split(",") for line in text.split("\n")[:-1]]
        column = rows[0].index("wall_seconds") if rows else 0
        return [row[:column] + row[column + 1:] for row in rows]

    def frames(self, out):
        with h5py.File(self.path(out, "fields.h5"), "r") as file:
            return [(frame.attrs["time"], {name: data[:] for name, data in frame.items()})
                    for frame in file["frames"].values()]

    def summary(self, out):
        with open(self.path(out, "summary.json")) as file:
            return json.load(file)

    def check_equal(self, out):
        """The run in the folder is to the last bit the one without a fault."""
        check(self.rows(out) == self.rows("whole"), "series.csv differs from that of a run without a fault")
        check(same_frames(self.frames(out), self.frames("whole")), "frames differ from those without a fault")
        here, there = self.summary(out), self.summary("whole")
        for key in ("status", "reason", "discharge_rate", "mass_error", "steps", "quasi_static_fraction", "back_offs"):
            check(here[key] == there[key], f"summary.json: {key} is {here[key]} instead of {there[key]}")

    def resume(self, out, *arguments):
        result = self.run(out, "--resume", *arguments)
        check(result.returncode == 0, f"--resume: exit status {result.returncode}: {result.stderr}")
        self.check_equal(out)
        return result

    def small_disk(self, size, options=""):
        disk = self.path(f"disk{len(self.mounts)}")
        os.mkdir(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}{options}", "none", disk],
                          capture_output=True).returncode:
            raise Skip("needs root, to mount a disk")
        self.mounts.append(disk)
        return disk

    def close(self):
        for disk in self.mounts:
            subprocess.run(["umount", "--lazy", disk], check=False)
        shutil.rmtree(self.folder, ignore_errors=True)


def same_frames(some, others):
    return len(some) == len(others) and all(
        t == u and a.keys() == b.keys() and all(numpy.array_equal(a[name], b[name]) for name in b)
        for (t, a), (u, b) in zip(some, others))


def needs(program):
    if not shutil.which(program):
        raise Skip(f"needs {program}")


def first_line(text):
    return text.strip().split("\n")[0]


# ---- kills and signals ---------------------------------------------------------------------------------------------

@fault("SIGKILL at random moments, each run killed and resumed ten times over",
       "rows and frames whole up to the last, resumed run equal to one without a fault")
def kills(b):
    whole, killed, lost, runs, at = b.frames("whole"), 0, 0, 0, []
    while killed < b.kills:
        out = f"kill{runs}"
        runs += 1
        for attempt in range(10):
            process = subprocess.Popen(b.command(out, "--resume"), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            try:
                process.wait(b.random.uniform(0.02, 1.5))
            except subprocess.TimeoutExpired:
                process.kill()
            words = process.communicate()[1].decode()
            if process.returncode == 0:
                break
            check(process.returncode == -signal.SIGKILL, f"exit status {process.returncode}: {words}")
            killed += 1
            rows = b.rows(out)
            check(len({len(row) for row in rows}) <= 1, "series.csv has a torn row")
            check(rows == b.rows("whole")[:len(rows)], "rows differ from those without a fault")
            if len(rows) > 1:
                frames = b.frames(out)
                due = sum(1 for t, _ in whole if t < float(rows[-1][0]))
                lost += due > len(frames)
                check(same_frames(frames, whole[:len(frames)]), "frames differ from those without a fault")
                at.append(int(rows[-1][1]))
            if killed == b.kills:
                break
        b.resume(out)
    check(lost == 0, f"{lost} of {killed} kills lost a frame")
    return (f"{killed} of {killed} lost no frame and no row; {runs} of {runs} resumed runs equal to the last bit "
            f"(killed at steps {min(at)} to {max(at)} of {STEPS})")


@fault("SIGKILL at every step of writing a checkpoint (fsync, rename)", "the checkpoint before, or this one, is whole")
def kill_in_checkpoint(b):
    needs("strace")
    tried = 0
    for call, most in (("fsync", 8), ("rename", 6)):
        for number in range(1, most + 1):
            out = f"{call}{number}"
            result = b.run(out, before=["strace", "-f", "-o", "/dev/null", "-e", f"inject={call}:signal=KILL:when={number}"])
            if result.returncode == 0:
                break
            check(result.returncode in (-9, 137), f"exit status {result.returncode}: {result.stderr}")
            b.resume(out)
            tried += 1
    check(tried > 8, f"only {tried} kills took place")
    return f"{tried} of {tried} resumed, equal to the last bit"


@fault("SIGKILL before every single write to fields.h5 and checkpoint.h5, of a run, and of a resumed one that first removes later frames",
       "fields.h5 can be read, with every frame whose writing had ended")
def kill_in_frame(b):
    needs("strace")
    short = ("--set", "time.max_steps=12")
    for out, steps in (("few", 12), ("later", 6)):
        result = b.run(out, "--set", f"time.max_steps={steps}")
        check(result.returncode == 0, result.stderr)
    with open(b.path("later", "checkpoint.h5"), "rb") as file:
        early = file.read()
    result = b.run("later", "--resume", *short)
    check(result.returncode == 0, result.stderr)
    with open(b.path("later", "checkpoint.h5"), "wb") as file:
        file.write(early)
    os.remove(b.path("later", "summary.json"))
    whole, tried, resumed = b.frames("few"), 0, 0
    for begin in ("", "later"):
        least = 0 if not begin else 3
        for number in range(1, 1000, b.thin):
            out = f"write{begin}{number}"
            if begin:
                shutil.copytree(b.path(begin), b.path(out))
            log = b.path("calls")
            result = b.run(out, "--resume", *short, before=["strace", "-f", "-o", log, "-e", "trace=pwrite64,ftruncate", "-e",
                                                            f"inject=pwrite64,ftruncate:signal=KILL:when={number}"])
            if result.returncode == 0:
                break
            check(result.returncode in (-9, 137), f"exit status {result.returncode}: {result.stderr}")
            tried += 1
            if os.path.exists(b.path(out, "fields.xdmf")):  # which is written behind each frame
                frames = b.frames(out)
                with open(b.path(out, "fields.xdmf")) as file:
                    named = file.read().count("<Time ")
                check(len(frames) >= (least if begin else named), f"write {number}: {len(frames)} frames of {named}")
                check(same_frames(frames, whole[:len(frames)]), f"write {number}: frames differ")
            if tried % 7 == 0:
                again = b.run(out, "--resume", *short)
                check(again.returncode == 0, again.stderr)
                check(b.rows(out) == b.rows("few") and same_frames(b.frames(out), whole), f"write {number}: resumed differs")
                resumed += 1
            shutil.rmtree(b.path(out))
    check(tried > 50 / b.thin, f"only {tried} kills took place")
    return f"{tried} of {tried} can be read; {resumed} of {resumed} resumed, equal to the last bit"


@fault("SIGINT, SIGTERM, SIGHUP", "checkpoint, row, frame, summary; exit status 130, 143, 129; resumes")
def signals(b):
    for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)):
        out = f"signal{status}"
        process = b.start(out)
        process.send_signal(number)
        words = process.communicate(timeout=60)[1]
        check(process.returncode == status, f"exit status {process.returncode} instead of {status}: {words}")
        check(b.summary(out)["status"] == "interrupted", "summary.json does not say interrupted")
        b.resume(out)
    return "130, 143, 129; resumed, equal to the last bit"


@fault("`timeout`, which sends SIGTERM to the process and again to its group",
       "the second one so soon does not count: checkpoint, summary")
def timeout(b):
    b.start("timeout").kill()
    result = b.run("timeout", "--resume", before=["timeout", "1"])
    check(result.returncode in (124, 143), f"exit status {result.returncode}: {result.stderr}")
    check(b.summary("timeout")["status"] == "interrupted", "no summary")
    b.resume("timeout")
    return "interrupted with a checkpoint; resumed, equal to the last bit"


@fault("SIGTERM again, 0.7 s later, within a step of a second or more", "exit status 143 at once; the files stay whole")
def two_signals(b):
    process = subprocess.Popen(b.command("twice", "--set", "grid.cells_x=1024", "--set", "accuracy=accurate", "--set",
                                         "accuracy.extrapolate=0"), stderr=subprocess.PIPE)
    while not b.rows("twice"):
        check(process.poll() is None, "the run did not begin")
        time.sleep(0.05)
    time.sleep(1)
    began = time.monotonic()
    process.send_signal(signal.SIGTERM)
    time.sleep(0.7)
    early = process.poll() is not None
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    check(process.returncode == 143, f"exit status {process.returncode}")
    check(early or time.monotonic() - began < 1.2, "did not end at once")
    check(len({len(row) for row in b.rows("twice")}) == 1, "series.csv has a torn row")
    return "143, 0.7 s after the first" if not early else "the step had ended before"


@fault("The reader of standard output goes away (`hourglass run ... | head -1`), or the output is on a full device",
       "the run goes on")
def no_reader(b):
    command = [word for word in b.command("pipe") if word != "--quiet"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    words = process.communicate()[1].decode()
    check(process.returncode == 0, f"exit status {process.returncode}: {words}")
    b.check_equal("pipe")
    command = [word for word in b.command("full_output") if word != "--quiet"]
    with open("/dev/full", "w") as full:
        result = subprocess.run(command, stdout=full, stderr=full, check=False)
    check(result.returncode == 0, f"exit status {result.returncode}")
    b.check_equal("full_output")
    return "to the end, equal to the last bit"


# ---- disks and files -----------------------------------------------------------------------------------------------

@fault("Full disk (a tmpfs of 2 MiB that is filled during the run)",
       "exit status 1, one line with the cause, summary; with room again it resumes")
def full_disk(b):
    told, tried = set(), range(0, 6, b.thin)
    for number in tried:
        disk = b.small_disk("2m")
        out = os.path.join(disk, "run")
        process = b.start(out)
        ballast = os.path.join(disk, "ballast")
        time.sleep(b.random.uniform(0, 0.5))
        with open(ballast, "wb", buffering=0) as file:
            try:
                while True:
                    file.write(bytes(512))
            except OSError:
                pass
        words = process.communicate(timeout=120)[1].strip()
        check(process.returncode == 1, f"exit status {process.returncode}: {words}")
        check(re.fullmatch("[^\n]*: No space left on device", words), f"told: {words}")
        check(b.summary(out)["reason"] == words, "summary.json gives another reason")
        check(len({len(row) for row in b.rows(out)}) == 1, "series.csv has a torn row")
        whole, frames = b.frames("whole"), b.frames(out)
        check(same_frames(frames, whole[:len(frames)]), "frames differ")
        os.remove(ballast)
        subprocess.run(["mount", "-o", "remount,size=40m", disk], check=True)
        b.resume(out)
        told.add(re.match(r"[^ :]*/([^ :/]*)", words).group(1))
    return f"{len(tried)} of {len(tried)} (it failed at {', '.join(sorted(told))}); resumed, equal to the last bit"


@fault("File size limit (`ulimit -f`)", "exit status 1, one line with the cause; resumes without the limit")
def size_limit(b):
    limit = 200_000
    result = b.run("limit", limit=(resource.RLIMIT_FSIZE, (limit, limit)))
    check(result.returncode == 1 and "File too large" in result.stderr, f"{result.returncode}: {result.stderr}")
    b.resume("limit")
    return f"1: `{os.path.basename(first_line(result.stderr))}`; resumed, equal to the last bit"


@fault("Read-only disk, from the start", "exit status 1, one line with the cause")
def read_only(b):
    disk = b.small_disk("2m", ",ro")
    result = b.run(os.path.join(disk, "run"))
    check(result.returncode == 1 and "Read-only file system" in result.stderr, f"{result.returncode}: {result.stderr}")
    check(len(result.stderr.strip().split("\n")) == 1, result.stderr)
    return "1: `run: " + first_line(result.stderr).split(": ", 1)[1] + "`"


@fault("fields.h5 may no longer be written (`chattr +i` during the run)",
       "exit status 1, one line with the cause; resumes when it may be again")
def immutable(b):
    process = b.start("immutable")
    file = b.path("immutable", "fields.h5")
    if subprocess.run(["chattr", "+i", file], capture_output=True).returncode:
        process.kill()
        process.communicate()
        raise Skip("needs root and a file system with attributes")
    words = process.communicate(timeout=120)[1].strip()
    subprocess.run(["chattr", "-i", file], check=True)
    check(process.returncode == 1 and "not permitted" in words, f"{process.returncode}: {words}")
    b.resume("immutable")
    return "1: `" + os.path.basename(words) + "`; resumed, equal to the last bit"


@fault("Pictures cannot be written (a file named `snapshots` is in the way)",
       "exit status 1, one line with the cause; resumes when it is gone")
def no_pictures(b):
    os.makedirs(b.path("pictures"))
    with open(b.path("pictures", "snapshots"), "w"):
        pass
    pictures = ("--set", "output.snapshots_every=5", "--set", "time.max_steps=300")
    result = b.run("pictures", *pictures)
    check(result.returncode == 1 and "snapshots" in result.stderr, f"{result.returncode}: {result.stderr}")
    os.remove(b.path("pictures", "snapshots"))
    again = b.run("pictures", "--resume", *pictures)
    check(again.returncode == 0, again.stderr)
    check(glob.glob(b.path("pictures", "snapshots", "speed_*.png")), "no pictures after that")
    return "1: `" + first_line(result.stderr).split("/")[-1] + "`; resumed"


@fault("No OpenGL: libEGL finds no driver", "one warning; the run goes on without pictures, which `render` draws later")
def no_graphics(b):
    pictures = ("--set", "output.snapshots_every=5")
    result = b.run("blind", *pictures, env={"__EGL_VENDOR_LIBRARY_FILENAMES": "/none", "__EGL_VENDOR_LIBRARY_DIRS": "/none",
                                            "LIBGL_DRIVERS_PATH": "/none"})
    check(result.returncode == 0, f"{result.returncode}: {result.stderr}")
    check(result.stderr.count("warning") == 1 and "no snapshots" in result.stderr, result.stderr)
    check(same_frames(b.frames("blind"), b.frames("whole")), "frames differ")
    drawn = subprocess.run([b.program, "render", b.path("blind"), "--field", "speed", "--time", "0"], capture_output=True)
    check(drawn.returncode == 0, drawn.stderr)
    return "0, one warning: `" + first_line(result.stderr)[9:] + "`"


@fault("The run folder is removed during the run", "exit status 1, one line with the cause")
def folder_removed(b):
    process = b.start("removed")
    shutil.rmtree(b.path("removed"), ignore_errors=True)
    shutil.rmtree(b.path("removed"), ignore_errors=True)
    words = process.communicate(timeout=120)[1].strip()
    check(process.returncode == 1 and len(words.split("\n")) == 1, f"{process.returncode}: {words}")
    return "1: `" + os.path.basename(words) + "`"


@fault("checkpoint.h5 damaged: a bit flipped at each of 60 places; cut off at 20 lengths",
       "found by its checksum; the previous one takes its place, or the run is refused, never another result")
def damaged(b):
    b.start("damage").kill()
    while not os.path.exists(b.path("damage", "checkpoint.previous.h5")):
        process = b.start("damage", "--resume")
        time.sleep(0.7)
        process.kill()
        process.communicate()
    newest = b.path("damage", "checkpoint.h5")
    with open(newest, "rb") as file:
        good = file.read()
    places = [len(good) * k // 60 for k in range(60)]
    broken = [good[:k] + bytes([good[k] ^ 1]) + good[k + 1:] for k in places]
    broken += [good[:len(good) * k // 20] for k in range(20)]
    broken = broken[::b.thin]
    for number, content in enumerate(broken):
        out = f"damage{number}"
        shutil.copytree(b.path("damage"), b.path(out))
        with open(b.path(out, "checkpoint.h5"), "wb") as file:
            file.write(content)
        if number % 16 == 0:
            check("damaged; going on from checkpoint.previous.h5" in b.resume(out).stderr, "the damage was not told")
        else:  # alone it must be refused
            os.remove(b.path(out, "checkpoint.previous.h5"))
            result = b.run(out, "--resume")
            check(result.returncode == 2 and "damaged" in result.stderr, f"{result.returncode}: {result.stderr}")
        shutil.rmtree(b.path(out))
    return f"{len(broken)} of {len(broken)} found; with the previous one equal to the last bit, without it exit status 2"


# ---- the machine ---------------------------------------------------------------------------------------------------

@fault("Clock set a year back and ten days forth during the run", "no effect: only a clock that nobody sets is asked")
def clock(b):
    library = glob.glob("/usr/lib/*/faketime/libfaketime.so.1")
    if not library:
        raise Skip("needs faketime")
    stamp = b.path("clock")
    with open(stamp, "w") as file:
        file.write("+0")
    process = b.start("clock_run", env={"LD_PRELOAD": library[0], "FAKETIME_TIMESTAMP_FILE": stamp, "FAKETIME_NO_CACHE": "1",
                                        "FAKETIME_DONT_FAKE_MONOTONIC": "1", "DONT_FAKE_MONOTONIC": "1"})
    for jump in itertools.cycle(("-365d", "+10d", "-1h", "+0")):
        time.sleep(0.2)
        if process.poll() is not None:
            break
        with open(stamp + ".new", "w") as file:
            file.write(jump)
        os.rename(stamp + ".new", stamp)
    words = process.communicate(timeout=600)[1]
    check(process.returncode == 0, words)
    b.check_equal("clock_run")
    seconds = [float(row["wall_seconds"]) for row in csv.DictReader(open(b.path("clock_run", "series.csv")))]
    check(all(x <= y for x, y in zip(seconds, seconds[1:])) and seconds[-1] < 600, "wall_seconds follow the clock")
    with open(b.path("clock_run", "run.log")) as file:
        log = file.read()
    years = {line[:4] for line in log.splitlines()}
    check(len(years) > 1, "the clock was not moved")
    due = seconds[-1] / CHECKPOINT_SECONDS
    count = log.count("checkpoint: ")
    check(due / 2 < count < due + 2, f"{count} checkpoints where {due:.1f} were due")
    return "equal to the last bit; checkpoints and `wall_seconds` go on evenly"


@fault("Two runs into one folder, also with `--force` and `--resume`", "the second is refused, exit status 2; the first goes on")
def two_runs(b):
    process = b.start("shared")
    for how in ((), ("--force",), ("--resume",)):
        result = b.run("shared", *how)
        check(process.poll() is None, "the first ended too soon")
        check(result.returncode == 2, f"{how}: {result.returncode}: {result.stderr}")
    words = process.communicate()[1]
    check(process.returncode == 0, words)
    b.check_equal("shared")
    return "2: `shared: " + result.stderr.strip().split("\n")[-1].split(": ", 1)[1] + "`"


@fault("`--threads` 1 to 64 on two cores, at the start and at a resume", "the same bits")
def threads(b):
    counts = [1, 2, 3, 4, 7, 8, 16, 32, 64][::b.thin]
    short = ("--set", "time.max_steps=40")
    result = b.run("one_thread", *short)
    check(result.returncode == 0, result.stderr)
    expected = b.rows("one_thread")
    for count in counts:
        for arguments in ((*short, "--threads"), ("--set", "time.max_steps=20", "--threads")):
            out = f"threads{count}_{len(arguments)}{arguments[1]}"
            command = [word for word in b.command(out) if word not in ("--threads", "1")]
            done = subprocess.run([*command, *arguments, str(count)], capture_output=True, text=True)
            check(done.returncode == 0, f"{count}: {done.stderr}")
        done = subprocess.run([*command, "--resume", *short, "--threads", str(count)], capture_output=True, text=True)
        check(done.returncode == 0, f"{count}: {done.stderr}")
        for out in (f"threads{count}_3time.max_steps=40", f"threads{count}_3time.max_steps=20"):
            check(b.rows(out) == expected, f"{count} threads: other bits")
            check(same_frames(b.frames(out), b.frames("one_thread")), f"{count} threads: other bits")
    return f"{len(counts)} of {len(counts)} equal to the last bit (on {os.cpu_count()} cores)"


@fault("Too little memory (`ulimit -v`)", "exit status 1, `out of memory`, nothing written")
def no_memory(b):
    limit = 1 << 30
    result = b.run("big", "--set", "grid.cells_x=4096", limit=(resource.RLIMIT_AS, (limit, limit)))
    check(result.returncode == 1 and "memory" in result.stderr, f"{result.returncode}: {result.stderr}")
    check(not os.path.exists(b.path("big")), "a folder was left")
    return "1: `" + result.stderr.strip().split("\n")[-1] + "`"


@fault("Resumed with another scene", "exit status 2, the first key that differs; nothing is touched")
def other_scene(b):
    process = b.start("other")
    process.terminate()
    process.communicate()
    before = {name: os.stat(b.path("other", name)).st_mtime_ns for name in os.listdir(b.path("other"))}
    result = b.run("other", "--resume", "--set", "materials.sand.mu_s=0.4")
    check(result.returncode == 2 and "materials.sand.mu_s is 0.32 there, 0.4 here" in result.stderr, result.stderr)
    check(before == {name: os.stat(b.path("other", name)).st_mtime_ns for name in os.listdir(b.path("other"))}, "touched")
    b.resume("other")
    return "2: `... materials.sand.mu_s is 0.32 there, 0.4 here. ...`"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--thin", type=int, default=1, help="of what is tried many times, only each so-manieth")
    parser.add_argument("--only", default="", help="faults whose function has this word in its name")
    parser.add_argument("--write", action="store_true", help="fill the table of docs/reliability.md")
    options = parser.parse_args()
    bench = Bench(options.program, options.kills, options.thin)
    lines, failed = [], 0
    try:
        for title, expected, function in FAULTS:
            if options.only not in function.__name__:
                continue
            began = time.monotonic()
            try:
                outcome = function(bench)
            except Skip as why:
                outcome = f"not tried: {why}"
            except (AssertionError, OSError, subprocess.SubprocessError) as why:
                failed += 1
                outcome = f"**FAILED**: {why}"
            outcome = outcome.replace(bench.folder + "/", "").replace("|", r"\|").replace("\n", " ")
            print(f"{function.__name__} ({time.monotonic() - began:.0f} s): {outcome}", flush=True)
            title = title.replace("|", r"\|")
            lines.append(f"| {title} | {expected} | {outcome} |")
    finally:
        bench.close()
    if options.write:
        page = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "docs", "reliability.md")
        with open(page) as file:
            text = file.read()
        table = "\n".join(["| fault | what should happen | what happened |", "|---|---|---|", *lines])
        text = re.sub("(<!-- faults: begin -->\n).*(\n<!-- faults: end -->)", lambda m: m[1] + table + m[2], text, flags=re.S)
        with open(page, "w") as file:
            file.write(text)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
