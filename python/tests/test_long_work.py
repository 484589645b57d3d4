"""Long work lets other threads run, and Ctrl-C ends it."""

import os
import signal
import subprocess
import sys
import threading
import time

import pytest
import saturated_hybrid as sh

# A shell ignores Ctrl-C for what it starts in the background, and that is handed down.
LONG = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
import saturated_hybrid as sh
print("begun", flush=True)
try:
    {work}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.parametrize(
    "work",
    [
        'sh.fly(sh.Scenario.built_in("paper").edited({"duration": 1e6}))',
        'sh.tune(sh.Scenario.built_in("study"), generations=100000)',
        '[sh.Governor(sh.Scenario.built_in("paper")).run(10_000_000) for _ in range(100)]',
    ],
)
def test_ctrl_c_ends_it_within_two_seconds(work):
    process = subprocess.Popen([sys.executable, "-c", LONG.format(work=work)], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "begun\n"
        time.sleep(0.5)
        assert process.poll() is None
        begun = time.monotonic()
        os.kill(process.pid, signal.SIGINT)
        assert process.communicate(timeout=10)[0] == "interrupted\n"
        assert process.returncode == 0 and time.monotonic() - begun < 2.0
    finally:
        process.kill()


def test_other_threads_run_meanwhile():
    counted, done = 0, threading.Event()

    def count():
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    begun = time.monotonic()
    sh.fly(sh.Scenario.built_in("paper").edited({"duration": 1000.0}))
    took = time.monotonic() - begun
    done.set()
    counter.join()
    assert took > 0.2, took
    # Held all the time, the lock would let it count once or twice.
    assert counted > 20 * took, (counted, took)
