"""Sweeps: the same table from every executor, in every order, after every kill; and cells that are right."""

from __future__ import annotations

import gc
import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
import tracemalloc
from concurrent.futures import Executor, Future
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from contact.laws import HertzContact, NewtonRestitution
from contact.orbits.settling import TOLERANCE, period_of
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from contact.stroboscope import StroboscopicMap
from contact.trajectory import State
from studies import ROOT
from studies.instruments.oscillators import single_mode_oscillator
from studies.instruments.scene_file import read_scene
from studies.instruments.sweep.column_scan import ColumnScan
from studies.instruments.sweep.executors import Pool, pool_of
from studies.instruments.sweep.run import AHEAD, WorkersLost, run_sweep
from studies.instruments.sweep.settled_column import LARGEST_PERIOD, SingleMode, repetition, returns
from studies.instruments.sweep.store import Store
from studies.instruments.sweep.tasks import Answer, Batch, Cell, Grid, Shard

FOLDER = Path(__file__).parent
SINGLE = single_mode_oscillator(read_scene(), 22.2)
PLAN = {"study": "test"}
LOGISTIC = Grid(
    frequencies=tuple(float(f) for f in range(12)), excesses=tuple(np.linspace(0.1, 1.0, 30).tolist())
)
SMALL = Grid(frequencies=(20.9, 21.5, 22.2), excesses=(-0.02, -0.005, -0.001, 0.001, 0.004, 0.013))
"""At 21.5 Hz p_4 lives down to -0.0132: the way up and the way down differ."""


def logistic(batch: Batch) -> Answer:
    """x -> 4 a x (1 - x), carried along: chaotic, so that one wrong bit anywhere shows everywhere after."""
    x = 0.3 + 0.01 * batch.frequency if batch.state is None else float(np.frombuffer(batch.state)[0])
    cells = []
    for excess in batch.excesses:
        for _ in range(200):
            x = 4.0 * excess * x * (1.0 - x)
        cells.append(Cell(period=0, impacts=0, cycles=200, reason="", state=np.array([x]).tobytes()))
    return Answer(cells=cells, seconds=1e-3)


def slow_logistic(batch: Batch) -> Answer:
    time.sleep(0.002)
    return Answer(cells=logistic(batch).cells, seconds=0.5)


def table(path: Path) -> list:
    with Store.read(path) as store:
        return list(store.rows())


def swept(path: Path, pool: Pool, work=logistic, grid: Grid = LOGISTIC, shard: Shard | None = None) -> list:
    with Store.begin(path, PLAN) as store:
        run_sweep(grid=grid, work=work, store=store, pool=pool, shard=shard)
    return table(path)


@pytest.fixture(scope="module")
def wanted(tmp_path_factory):
    """The table of the logistic sweep without any of this: one loop a chain."""
    rows = []
    for chain in LOGISTIC.chains(Shard()):
        state = None
        for column in chain:
            for step, excess in enumerate(column.excesses):
                batch = Batch(column=column.number, frequency=column.frequency, direction=column.direction,
                              first_step=step, excesses=(excess,), state=state)  # fmt: skip
                (cell,) = logistic(batch).cells
                state = cell.state
                place = (column.number, column.frequency, column.direction, step, excess)
                rows.append((*place, 0, 0, 200, "", state))
    return rows


class Backwards(Executor):
    """Computes when somebody waits, and what came last first."""

    def __init__(self) -> None:
        self.kept: list[tuple[Future, tuple]] = []
        self.most = 0

    def submit(self, function, /, *arguments):
        future: Future = Future()
        self.kept.append((future, (function, *arguments)))
        self.most = max(self.most, len(self.kept))
        if len(self.kept) > 3:
            self.work()
        return future

    def work(self) -> None:
        while self.kept:
            future, (function, *arguments) = self.kept.pop()
            future.set_result(function(*arguments))


def test_the_table_does_not_depend_on_threads_order_or_shards(tmp_path, wanted):
    with pool_of("threads", 3) as pool:
        assert swept(tmp_path / "threads.sqlite", pool) == wanted
        for k in (3, 1, 2):
            part = swept(tmp_path / f"{k}.sqlite", pool, shard=Shard.of_text(f"{k}/3"))
            assert len(part) == len(wanted) / 3
    with Store.begin(tmp_path / "shards.sqlite", PLAN) as store:
        for k in (2, 1, 3):
            with Store.read(tmp_path / f"{k}.sqlite") as part:
                store.gather(part)
    assert table(tmp_path / "shards.sqlite") == wanted
    backwards = Backwards()
    pool = Pool(executor=backwards, name="backwards", count=lambda: 2)
    assert swept(tmp_path / "backwards.sqlite", pool) == wanted
    assert backwards.most == 2 * AHEAD


def small_table(path: Path, place: str) -> list:
    with pool_of(place, 2) as pool:
        return swept(path, pool, ColumnScan(oscillator=SINGLE, most_cycles=256), SMALL)


def test_processes_give_the_bits_of_threads(tmp_path):
    threads = small_table(tmp_path / "threads.sqlite", "")
    assert len(threads) == 36 and len({row[9] for row in threads}) > 18
    assert small_table(tmp_path / "processes.sqlite", "processes") == threads


def test_a_real_cluster_gives_the_bits_of_threads(tmp_path):
    distributed = pytest.importorskip("distributed")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(FOLDER)])}
    with distributed.LocalCluster(
        n_workers=2, processes=True, threads_per_worker=1, dashboard_address=None, silence_logs=50,
        env=environment,
    ) as cluster:  # fmt: skip
        place = cluster.scheduler_address.replace("tcp://", "dask://")
        assert len(set(cluster.scheduler.workers)) == 2
        pids = {worker.process.process.pid for worker in cluster.workers.values()}
        assert len(pids) == 2 and os.getpid() not in pids
        there = small_table(tmp_path / "cluster.sqlite", place)
    assert there == small_table(tmp_path / "threads.sqlite", "threads")


def test_places_that_do_not_exist_are_refused(monkeypatch):
    for place, words in (("gpu", "must be threads, processes or dask"), ("dask://", "must be threads")):
        with pytest.raises(ValueError, match=words), pool_of(place, 1):
            pass
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ValueError, match=r"grazing-spring\[cluster\]"), pool_of("dask://127.0.0.1:1", 1):
        pass


KILLED = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from test_sweep_child import LOGISTIC, PLAN, slow_logistic
from studies.instruments.sweep.executors import pool_of
from studies.instruments.sweep.run import run_sweep
from studies.instruments.sweep.store import Store
with Store.begin(Path(sys.argv[1]), PLAN) as store, pool_of("threads", 2) as pool:
    print("begun", flush=True)
    run_sweep(grid=LOGISTIC, work=slow_logistic, store=store, pool=pool)
"""


def child_of(path: Path, code: str, *arguments: str) -> subprocess.Popen:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        [sys.executable, "-c", code, str(path), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, env=environment, cwd=ROOT,
    )  # fmt: skip


def light_child(folder: Path) -> str:
    """The logistic sweep as a module that imports little, so that a child is soon at work."""
    import inspect

    names, values = "Answer, Batch, Cell, Grid", (LOGISTIC.frequencies, LOGISTIC.excesses)
    source = f"import time\nimport numpy as np\nfrom studies.instruments.sweep.tasks import {names}\n"
    source += f"PLAN = {PLAN!r}\nLOGISTIC = Grid(frequencies={values[0]!r}, excesses={values[1]!r})\n"
    source += inspect.getsource(logistic) + inspect.getsource(slow_logistic)
    (folder / "test_sweep_child.py").write_text(source)
    return str(folder)


def killed_and_resumed(path: Path, kills: int, folder: Path, seed: int) -> int:
    """Kill a sweep at random moments, resume it, and let the last one finish; returns kills in mid-sweep."""
    chance, hit, module = random.Random(seed), 0, light_child(folder)
    for attempt in range(kills + 1):
        with child_of(path, KILLED, module) as child:
            assert child.stdout is not None and child.stderr is not None
            assert child.stdout.readline() == "begun\n", child.stderr.read()
            if attempt < kills:
                time.sleep(chance.uniform(0.0, 0.12))
                child.kill()
                child.wait(timeout=30)
                hit += child.returncode == -signal.SIGKILL
            else:
                assert child.wait(timeout=60) == 0, child.stderr.read()
        with sqlite3.connect(path) as connection:
            assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    return hit


def test_killed_at_random_moments_it_ends_with_the_identical_table(tmp_path, wanted):
    assert killed_and_resumed(tmp_path / "s.sqlite", 10, tmp_path, seed=7) >= 3
    assert table(tmp_path / "s.sqlite") == wanted


CHART = "from studies.chart import main; import sys; sys.exit(main(sys.argv[2:] + ['--out', sys.argv[1]]))"


def stored(path: Path) -> int:
    """Cells in a store that may not be there yet."""
    try:
        with Store.read(path) as store:
            return store.count()
    except (OSError, ValueError):
        return 0


@pytest.mark.slow
def test_the_chart_itself_killed_ten_times_ends_with_the_identical_table(tmp_path):
    size = ("--points", "40", "60", "--cycles", "512")
    with child_of(tmp_path / "whole", CHART, *size) as child:
        assert child.wait(timeout=600) == 0
    chance, name = random.Random(3), Path("chart") / "single_mode-40x60.sqlite"
    grown = []
    for attempt in range(11):
        with child_of(tmp_path / "cut", CHART, *size) as child:
            if attempt < 10:
                # at a random moment of the work, however fast the machine is
                wanted = (grown[-1] if grown else 0) + chance.randint(1, 300)
                while child.poll() is None and stored(tmp_path / "cut" / name) < wanted:
                    time.sleep(0.005)
                child.kill()
                child.wait(timeout=30)
            else:
                assert child.wait(timeout=600) == 0
        if (tmp_path / "cut" / name).exists():
            with Store.read(tmp_path / "cut" / name) as store:
                grown.append(store.count())
    assert grown == sorted(grown) and len(set(grown)) >= 3
    assert table(tmp_path / "cut" / name) == table(tmp_path / "whole" / name)


def test_ctrl_c_stores_what_has_come_back_and_a_second_run_goes_on(tmp_path, wanted):
    def interrupted(cells: int) -> None:
        seen.append(cells)
        if sum(seen) > 100:
            raise KeyboardInterrupt

    seen: list[int] = []
    with Store.begin(tmp_path / "s.sqlite", PLAN) as store, pool_of("threads", 2) as pool:
        with pytest.raises(KeyboardInterrupt):
            run_sweep(grid=LOGISTIC, work=logistic, store=store, pool=pool, tell=interrupted)
        kept = store.count()
        assert sum(seen) <= kept < len(wanted)
        seen.clear()
        run_sweep(grid=LOGISTIC, work=logistic, store=store, pool=pool, tell=seen.append)
        assert sum(seen) == len(wanted) - kept
    assert table(tmp_path / "s.sqlite") == wanted


def test_ctrl_c_on_the_chart_says_how_to_go_on(tmp_path):
    argv = ("--points", "60", "400", "--cycles", "4096")
    with child_of(tmp_path, CHART, *argv) as child:
        path = tmp_path / "chart" / "single_mode-60x400.sqlite"
        for _ in range(600):
            time.sleep(0.05)
            if path.exists() and path.with_name(path.name + "-wal").exists():
                with sqlite3.connect(path) as connection:
                    names = [name for (name,) in connection.execute("SELECT name FROM sqlite_master")]
                    if "cells" in names:
                        if connection.execute("SELECT count(*) FROM cells").fetchone()[0] > 20:
                            break
        child.send_signal(signal.SIGINT)
        _out, err = child.communicate(timeout=60)
    assert child.returncode == 130
    assert "Traceback" not in err
    assert f"go on with: python -m studies.chart {' '.join(argv)}" in err
    assert len(table(path)) > 20


def test_lost_workers_are_one_sentence(tmp_path):
    class Broken(Backwards):
        def submit(self, function, /, *arguments):
            future: Future = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    with Store.begin(tmp_path / "s.sqlite", PLAN) as store:
        with pytest.raises(WorkersLost, match="the broken ended before the sweep did"):
            run_sweep(grid=LOGISTIC, work=logistic, store=store,
                      pool=Pool(executor=Broken(), name="broken", count=lambda: 1))  # fmt: skip


def test_another_program_on_a_worker_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("studies.instruments.sweep.run._answered", lambda work, batch: (work(batch), "older"))
    with Store.begin(tmp_path / "s.sqlite", PLAN) as store, pool_of("threads", 1) as pool:
        with pytest.raises(WorkersLost, match="another version of the program"):
            run_sweep(grid=LOGISTIC, work=logistic, store=store, pool=pool)
        assert store.count() == 0


def still(batch: Batch) -> Answer:
    cell = Cell(period=1, impacts=0, cycles=0, reason="", state=bytes(8))
    return Answer(cells=[cell] * len(batch.excesses), seconds=1e-6)


def test_memory_stays_flat(tmp_path):
    """What is held at the end depends neither on columns nor on cells; meanwhile the interpreter keeps some
    of what it has freed, 140 bytes for each column in a direction."""
    peaks, held = [], []
    for columns, rows in ((20, 40), (20, 40), (200, 40), (20, 400)):  # the first one pays for imports
        frequencies, excesses = np.arange(float(columns)), np.arange(float(rows))
        grid = Grid(frequencies=tuple(frequencies.tolist()), excesses=tuple(excesses.tolist()))
        name = f"{columns}-{len(peaks)}.sqlite"
        with Store.begin(tmp_path / name, PLAN) as store, pool_of("", 2) as pool:
            tracemalloc.start()
            run_sweep(grid=grid, work=still, store=store, pool=pool)
            peaks.append(tracemalloc.get_traced_memory()[1])
            gc.collect()  # gives back what the interpreter keeps for reuse, too
            held.append(tracemalloc.get_traced_memory()[0])
            tracemalloc.stop()
            assert store.count() == 2 * rows * columns
    assert max(held[2:]) < held[1] + 20_000
    assert max(peaks[2:]) < peaks[1] + 360 * 200


def test_a_failed_cell_is_a_row_with_its_reason_and_the_scan_goes_on(monkeypatch):
    from studies.instruments.sweep import column_scan as module

    compiled, calls = module.settled_column, []

    def failing(motion, single, amplitudes, state, weight, *rest):
        calls.append(amplitudes.size)
        if len(calls) == 1:
            done, status, _index = compiled(motion, single, amplitudes[:2], state, weight, *rest)
            assert (done, status) == (2, 0)
            n = motion.omega.size
            rest[4][:] = 0.0
            rest[4][2 * n] = 0.01
            return 2, 2, 17  # FAILED_CHATTER in drive period 17
        return compiled(motion, single, amplitudes, state, weight, *rest)

    monkeypatch.setattr(module, "settled_column", failing)
    scan = ColumnScan(oscillator=SINGLE, most_cycles=256)
    excesses = (-0.01, -0.005, 0.001, 0.002)
    batch = Batch(column=0, frequency=22.2, direction="up", first_step=0, excesses=excesses, state=None)
    answer = scan(batch)
    assert calls == [4, 1]
    assert [bool(cell.reason) for cell in answer.cells] == [False, False, True, False]
    reason = answer.cells[2].reason
    assert reason.startswith("Chatter: impacts accumulate at t = ") and "\n" not in reason
    time_told = float(reason.split("t = ")[1].split(" s")[0])
    assert time_told == pytest.approx(17 / 22.2 + 0.01)
    assert answer.cells[2].state == answer.cells[1].state and answer.cells[3].period == 5


def test_a_state_behind_the_stop_is_a_failed_cell():
    start = np.array([1.01 * SINGLE.stop.gap, 0.0, 0.0, 0.0, 0.0]).tobytes()
    scan = ColumnScan(oscillator=SINGLE, most_cycles=128)
    (cell,) = scan(
        Batch(column=0, frequency=22.2, direction="up", first_step=0, excesses=(0.01,), state=start)
    ).cells
    assert "behind the stop" in cell.reason and cell.state == start


def followed(oscillator: ImpactOscillator, excess: float, before: bytes | None, cell: Cell):
    """The same cell by the period map and `period_of`: (period, impacts) when chaos below a fold, which lasts
    as long as rounding decides, has ended; and the state after as many drive periods as the cell took."""
    here, n = StroboscopicMap(oscillator=oscillator).at(excess), oscillator.n_modes
    start = here.steady()
    if before is not None:
        numbers = np.frombuffer(before)
        start = State(displacement=numbers[:n], velocity=numbers[n : 2 * n], regime=int(numbers[2 * n]))
    run = here.orbit(start, 16384)
    period = period_of(run.points, run.impacts, largest_period=64, tolerance=TOLERANCE * here.scale)
    end = here.orbit(start, cell.cycles).end if cell.cycles else here.steady()
    found = (period, int(run.impacts[-period:].sum()) if period else -1)
    return found, np.concatenate([end.displacement, end.velocity])


@pytest.mark.parametrize(("law", "frequency"), [("newton", 21.5), ("newton", 22.2), ("hertz", 22.2)])
def test_cells_agree_with_the_period_map(law, frequency):
    contact = NewtonRestitution(local_restitution=0.1) if law == "newton" else HertzContact(stiffness=1e9)
    scan = ColumnScan(
        oscillator=replace(SINGLE, stop=Stop(gap=SINGLE.stop.gap, law=contact)), most_cycles=1024
    )
    oscillator, state, kinds = scan.at_frequency(frequency), None, []
    speed = 2 * np.pi * frequency
    for way, excesses in (("up", SMALL.excesses), ("down", SMALL.excesses[::-1])):
        here = Batch(
            column=0, frequency=frequency, direction=way, first_step=0, excesses=excesses, state=state
        )
        for excess, cell in zip(excesses, scan(here).cells, strict=True):
            found, end = followed(oscillator, excess, state, cell)
            reached, state = np.frombuffer(cell.state), cell.state
            if cell.cycles >= 1024:  # chaos, or nearly periodic at the bound
                assert cell.period in (0, found[0])  # one that has not settled says nothing of what comes
                continue
            assert (cell.period, cell.impacts) == found
            kinds.append(found)
            if cell.impacts:
                assert abs(reached[0] - end[0]) < 1e-9 * oscillator.stop.gap
                assert abs(reached[1] - end[1]) < 1e-9 * oscillator.stop.gap * speed
            else:  # put on the steady motion
                steady = StroboscopicMap(oscillator=oscillator).at(excess).steady()
                assert reached[:2] == pytest.approx([steady.displacement[0], steady.velocity[0]], rel=1e-12)
    assert len(kinds) >= 10 and (1, 0) in kinds and any(period > 1 for period, _ in kinds)


@pytest.mark.parametrize("frequency", [19.8, 20.9, 21.5, 22.6])
def test_the_loop_of_one_mode_gives_the_cells_of_the_event_loop(frequency, monkeypatch):
    """Both ways through a column, without the amplitudes at which the motion is chaotic."""
    from studies.instruments.sweep import column_scan as module

    up = tuple(np.linspace(-0.03, 0.03, 41).tolist())
    scan = ColumnScan(oscillator=SINGLE, most_cycles=1024)

    def cells() -> list[Cell]:
        state, found = None, []
        for way, excesses in (("up", up), ("down", up[::-1])):
            batch = Batch(
                column=0, frequency=frequency, direction=way, first_step=0, excesses=excesses, state=state
            )
            found += scan(batch).cells
            state = found[-1].state
        return found

    fast, singles = cells(), []
    compiled = module.settled_column

    def general(motion, single, *rest):
        singles.append(single)
        return compiled(motion, None, *rest)

    monkeypatch.setattr(module, "settled_column", general)
    slow = cells()
    assert len(singles) == 2 and all(isinstance(single, SingleMode) for single in singles)
    gap, periods, compared = SINGLE.stop.gap, set(), 0
    for mine, theirs in zip(fast, slow, strict=True):
        if max(mine.cycles, theirs.cycles) > 400:
            # chaos, or chaos for a while: rounding decides how long it lasts and where it leads
            if (mine.period, mine.impacts) == (theirs.period, theirs.impacts) == (1, 0):
                continue
            break
        compared += 1
        assert (mine.period, mine.impacts, mine.cycles) == (theirs.period, theirs.impacts, theirs.cycles)
        ours, general_state = np.frombuffer(mine.state), np.frombuffer(theirs.state)
        assert np.abs(ours - general_state)[0] < 1e-10 * gap
        assert np.abs(ours - general_state)[1] < 1e-10 * gap * 2 * np.pi * frequency
        periods.add(mine.period)
    assert compared > 15 and (len(periods) >= 2 or frequency < 20)


def test_slow_convergence_next_to_a_fold_is_told_at_the_bound():
    """p_3 at 20.90 Hz, 1 % above its fold at -1.2784409283e-3: its multiplier is near 1."""
    fold = -1.2784409283e-3
    above, below = 0.99 * fold, 1.02 * fold
    for excess, wanted in ((above, (3, 1)), (below, (1, 0))):
        found = []
        for most in (256, 8192):
            scan, state = ColumnScan(oscillator=SINGLE, most_cycles=most), None
            here = Batch(column=0, frequency=20.9, direction="down", first_step=0,
                         excesses=(0.005, 0.0, -1e-3, -1.2e-3, excess), state=state)  # fmt: skip
            cell = scan(here).cells[-1]
            found.append((cell.period, cell.impacts))
        assert found[1] == wanted
        assert found[0] in (wanted, (0, found[0][1]))


def test_repetition_is_period_of():
    """On sequences with every period, with a flaw in each place, and on noise."""
    chance, seen = np.random.default_rng(5), set()
    for stretch in (16, 32):
        for _ in range(300):
            p = int(chance.integers(1, stretch + 4))
            points = np.tile(chance.normal(size=(p, 2)), (2 * stretch // p + 1, 1))[: 2 * stretch].copy()
            impacts = np.tile(chance.integers(0, 2, size=p), 2 * stretch // p + 1)[: 2 * stretch].copy()
            points += 1e-9 * chance.uniform(-0.45, 0.45, size=points.shape)
            kind = chance.integers(0, 3)
            if kind == 1:
                points[chance.integers(0, 2 * stretch), chance.integers(0, 2)] += 5e-9
            if kind == 2:
                impacts[chance.integers(0, 2 * stretch)] += 1
            found = repetition(points, impacts, 2 * stretch, stretch, 1e-9)
            assert returns(points, 2 * stretch, 1e-9) or not found
            assert found == period_of(points, impacts, largest_period=stretch, tolerance=1e-9)
            seen.add(found)
    assert len(seen) > 25 and 0 in seen
    assert not returns(np.arange(128.0)[:, None] * np.ones(2), 128, 1e-9)
    for place, wanted in ((127 - LARGEST_PERIOD, True), (126 - LARGEST_PERIOD, False)):
        points = np.arange(128.0)[:, None] * np.ones(2)
        points[place, 0] = points[127, 0] + 1e-10
        assert returns(points, 128, 1e-9) == wanted


def test_shards_and_grids_are_checked():
    for text in ("2", "0/3", "4/3", "a/b", "-1/2"):
        with pytest.raises(ValueError, match="shard"):
            Shard.of_text(text)
    with pytest.raises(ValueError, match="rising order"):
        Grid(frequencies=(1.0, 1.0), excesses=(0.0,))
    counts = [LOGISTIC.cells(Shard(number=k, count=5)) for k in range(1, 6)]
    assert sum(counts) == LOGISTIC.cells(Shard()) == 720 and max(counts) - min(counts) <= 60
