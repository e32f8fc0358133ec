"""A clock that jumps to and fro by up to years, for native code too: no verdict changes."""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
from functools import cache
from pathlib import Path

from tests.campaigns.attacks import trial
from tests.campaigns.attacks.workshop import COMMANDS

SOURCE = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>
static uint64_t state;
static int64_t jump(void) {
  if (!state) { const char *seed = getenv("JUMPS"); state = seed ? strtoull(seed, 0, 10) : 1; }
  state = state * 6364136223846793005ULL + 1442695040888963407ULL;
  int64_t size = 1LL << ((state >> 33) % 27);
  return (state >> 62) & 1 ? size : -size;
}
int clock_gettime(clockid_t clock, struct timespec *now) {
  static int (*real)(clockid_t, struct timespec *);
  if (!real) real = (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT, "clock_gettime");
  int code = real(clock, now);
  if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE) now->tv_sec += jump();
  return code;
}
int gettimeofday(struct timeval *now, void *zone) {
  struct timespec time;
  clock_gettime(CLOCK_REALTIME, &time);
  now->tv_sec = time.tv_sec; now->tv_usec = time.tv_nsec / 1000; (void)zone;
  return 0;
}
time_t time(time_t *to) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (to) *to = now.tv_sec;
  return now.tv_sec;
}
"""


@cache
def library(folder: Path) -> Path:
    """The library whose clock jumps."""
    source, built = folder / "jumps.c", folder / "jumps.so"
    source.write_text(SOURCE)
    subprocess.run(["cc", "-shared", "-fPIC", "-o", built, source, "-ldl"], check=True)
    return built


def attack(rng: random.Random, master: Path, folder: Path) -> tuple[str, list[str]]:
    """One command with and without the jumps; what it was, and the findings."""
    command = rng.choice([each for each in COMMANDS if not each.serves])
    ends: list[tuple[int, list[str]]] = []
    said = ""
    for number, name in enumerate(("still", "jumping")):
        place = trial.workplace(master, folder / name)
        environment = {**os.environ, "TMPDIR": str(place / ".tmp")}
        if number:
            environment |= {
                "LD_PRELOAD": str(library(master.parent)),
                "JUMPS": str(rng.getrandbits(32)),
            }
        done = subprocess.run(
            [sys.executable, "-m", "harness.cli", *command.plain()], cwd=place, env=environment,
            input=command.stdin, capture_output=True, text=True, check=False,
            timeout=trial.LONGEST_WAIT,
        )  # fmt: skip
        said = done.stdout + done.stderr
        ends.append((done.returncode, digests(place / "out")))
    found = [] if ends[0] == ends[1] else [f"{ends[0]} became {ends[1]}"]
    found += ["a traceback"] if trial.TRACEBACK in said else []
    return command.name, [f"{each}\n{said[-1500:]}" for each in found]


def digests(folder: Path) -> list[str]:
    """The digests of the runs in a folder."""
    return [json.loads(each.read_text())["digest"] for each in sorted(folder.rglob("run.json"))]
