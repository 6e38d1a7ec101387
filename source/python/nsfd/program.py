"""Starts the program and tells how it ended."""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass, replace
from pathlib import Path

from .errors import SETTINGS, FolderError, InputError, ProgramError, read_problems
from .scene import Scene, flat_entries

DONE, BAD_INPUT, NOT_SOLVED, STOPPED = 0, 1, 3, 4


def find_program(program=None):
    """The path of nsfd: the argument, the environment variable NSFD, PATH, the
    one that was installed with this package, or that of the checkout."""
    here = Path(__file__).resolve()
    named = program or os.environ.get("NSFD")
    # PREFIX/lib/python3/dist-packages/nsfd, CHECKOUT/source/python/nsfd
    near = [here.parents[4] / "bin" / "nsfd", here.parents[3] / "nsfd"]
    for one in [named] if named else ["nsfd", *near]:
        found = shutil.which(os.fspath(one))
        if found:
            return os.path.abspath(found)
    if named:
        raise ProgramError(f"the program '{named}' is not there, or cannot be run")
    raise ProgramError(
        "the program nsfd was not found: name it as run(..., program=PATH), in the "
        "environment variable NSFD, or have its folder in PATH"
    )


@dataclass(frozen=True)
class Call:
    """What a call of the program was asked for, besides the scene."""

    output: Path
    settings: dict
    ranks: int = 1
    force: bool = False
    resume: bool = False
    quiet: bool = True
    plug_ins: tuple = ()
    program: str = None

    def words(self, file, subcommand, more=()):
        if self.force and self.resume:
            raise ValueError("force begins again, resume goes on: write one of them")
        words = [find_program(self.program), subcommand, str(file), *more]
        for path, text in flat_entries(self.settings):
            words += ["--set", f"{path}={text}"]
        words += ["--output", str(self.output)]
        for plug_in in self.plug_ins:
            words += ["--plug-in", os.fspath(plug_in)]
        for wanted, word in (
            (self.force, "--force"),
            (self.resume, "--resume"),
            (self.quiet, "--quiet"),
        ):
            words += [word] * wanted
        return words


def call_program(scene, call, subcommand, load, more=()):
    """Runs a scene and returns (what load(folder) returns, its exit code, the
    report of standard error, its problems). Raises InputError, FolderError,
    ProgramError; KeyboardInterrupt after the program has stored its state."""
    with scene.as_file() as file:
        words = call.words(file, subcommand, more)
        code, report, interrupted = _run(words, call.ranks, call.quiet)
        report = re.sub("^--set: ", f"{SETTINGS}: ", report, flags=re.MULTILINE)
        handed_over = None if file == scene.path else str(file)

        def entry_at(name, line):
            return _entry_at(scene if name == handed_over else name, line)

        problems = read_problems(report, entry_at)
    if handed_over:
        report = report.replace(handed_over, scene.name)
        problems = [_renamed(one, handed_over, scene.name) for one in problems]
    report = _without_mpirun(report).strip() or report.strip()
    in_time = code == STOPPED and "nothing had been computed" not in report
    if interrupted:
        reads = f"nsfd.load({str(call.output)!r}) reads what there is"
        raise KeyboardInterrupt(
            f"stopped: {reads}, and the same call with resume=True goes on"
            if in_time
            else f"at the end of the run: {reads}"
            if code == DONE
            else "ended before there was anything to store"
        )
    if code == BAD_INPUT:
        wrong = [one for one in problems if one.kind == "error"]
        if wrong:
            raise InputError(report, wrong)
        if _without_mpirun(report).strip():
            raise FolderError(_in_python(report))
    if code not in (DONE, NOT_SOLVED, STOPPED):
        # also of mpirun, which may have started nothing
        raise ProgramError(report or f"nsfd ended with {code}", code)
    has_results = in_time or code != STOPPED
    return load(call.output) if has_results else None, code, report, problems


def _renamed(problem, old, new):
    return replace(
        problem,
        file=new if problem.file == old else problem.file,
        text=problem.text.replace(old, new),
        advice=problem.advice.replace(old, new),
    )


def _entry_at(source, line):
    try:
        scene = source if isinstance(source, Scene) else Scene(Path(source))
        return scene.entry_at(line)
    except OSError:
        return None


def _without_mpirun(report):
    """Without what mpirun adds, in frames of dashes, where a rank did not end
    with 0."""
    return re.sub(r"(?ms)^-{40,}$.*?^-{40,}$", "", report)


def _in_python(report):
    """The advice of the program about folders, as it is written here."""
    for option, word in (
        ("--output DIR", "output=FOLDER"),
        ("--force", "force=True"),
        ("--resume", "resume=True"),
    ):
        report = report.replace(option, word)
    return report


def _environment(ranks, scratch):
    """Of several ranks: mpirun may run as root and with more ranks than cores,
    and what it keeps of one run is not removed by another one that ends."""
    variables = dict(os.environ)
    if ranks > 1:
        variables["OMPI_MCA_orte_tmpdir_base"] = scratch
        for name, value in (
            ("OMP_NUM_THREADS", "1"),
            ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
            ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
            ("OMPI_MCA_rmaps_base_oversubscribe", "1"),
        ):
            variables.setdefault(name, value)
    return variables


def _run(words, ranks, quiet):
    """(exit code, text of standard error, whether Ctrl-C ended it)"""
    if ranks != int(ranks) or ranks < 1:
        raise ValueError(f"ranks = {ranks} must be a whole number from 1 on")
    if ranks > 1:
        if not shutil.which("mpirun"):
            raise ProgramError("several ranks need mpirun, which is not in PATH")
        words = ["mpirun", "-n", str(int(ranks)), *words]
    with tempfile.TemporaryDirectory(prefix="nsfd_") as scratch:
        # A session of its own: Ctrl-C of a terminal reaches it through us only,
        # once. Were this process killed, the closed pipe would stop the program.
        process = subprocess.Popen(
            words,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
            env=_environment(ranks, scratch),
            start_new_session=True,
        )
        try:
            report, interrupted = _watch(process, ranks, quiet)
        except BaseException:
            process.kill()
            raise
    return process.returncode, report, interrupted


def _watch(process, ranks, quiet):
    """Reads what it says until it has ended: (standard error, interrupted)"""
    report = []
    readers = [
        threading.Thread(target=_show, args=(process.stdout, quiet), daemon=True),
        threading.Thread(target=lambda: report.extend(process.stderr), daemon=True),
    ]
    for reader in readers:
        reader.start()
    interrupted = _wait(process, ranks)
    for reader in readers:
        reader.join()
    process.stdout.close()
    process.stderr.close()
    return "".join(report), interrupted


def _show(stream, quiet):
    for line in stream:
        if not quiet:
            sys.stdout.write(line)
            sys.stdout.flush()


def _wait(process, ranks):
    """Until it has ended; True if Ctrl-C was pressed, which lets it store its
    state first. A second one does not."""
    try:
        process.wait()
        return False
    except KeyboardInterrupt:
        # mpirun hands on this signal, and kills its ranks at SIGINT
        process.send_signal(signal.SIGUSR1 if ranks > 1 else signal.SIGINT)
    try:
        process.wait()
    except KeyboardInterrupt:
        process.terminate()
        try:
            process.wait(5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    return True
