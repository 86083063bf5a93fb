import os
import signal
import subprocess
import sys
import time

import pytest

from experiments.runs.processes import as_done, process_pool

CTRL_C = """
import time
from experiments.runs.processes import as_done, process_pool
if __name__ == "__main__":
    with process_pool(1) as pool:
        pool.submit(abs, -1).result()
        print("working", flush=True)
        for _ in as_done({k: pool.submit(time.sleep, 60) for k in range(3)}):
            pass
"""


@pytest.mark.slow
def test_calls_come_back_with_their_keys_from_other_processes():
    with process_pool(2, calls=3) as pool:
        calls = {n: pool.submit(divmod, n, 2) for n in (3, 4)}
        calls["process"] = pool.submit(os.getpid)
        found = {key: call.result() for key, call in as_done(calls)}
    assert found[3] == (1, 1)
    assert found[4] == (2, 0)
    assert found["process"] != os.getpid()


@pytest.mark.slow
def test_ctrl_c_ends_workers_at_once_and_only_the_parent_speaks(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(CTRL_C)
    run = subprocess.Popen(
        [sys.executable, script],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert run.stdout.readline() == "working\n"
    began_s = time.monotonic()
    os.killpg(run.pid, signal.SIGINT)
    _, said = run.communicate(timeout=50)
    assert time.monotonic() - began_s < 30  # not the sleep's minute
    assert said.count("Traceback") == 1
    assert said.rstrip().endswith("KeyboardInterrupt")
