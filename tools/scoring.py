"""Shared by the scripts that score many scenes."""
import argparse, contextlib, json, os, shutil, signal, subprocess, sys

signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # `tools/streets | head` ends without a traceback

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
CURBLINE = os.environ.get("CURBLINE", os.path.join(ROOT, "build", "bin", "curbline"))
LASERS = ["utm30lx", "lms151", "lms200"]
# A localisation that corrects itself in steps, for a robot's [simulated].
JUMPS = "pose_jump_every_s = 1.5\npose_jump_height_m = 0.02\npose_jump_attitude_rad = 0.007"
METHODS = ["segment", "em", "crf-em", "curbline", "canny", "gradient"]


class Words(argparse.ArgumentParser):
    """The command line of a script. An error is reported in one line, with exit status 2."""

    def __init__(self, doc, out):
        super().__init__(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)
        self.add_argument("--out", default=os.path.join(ROOT, out))

    def parse_args(self):
        """Refuses an option given twice, as curbline does; argparse alone would take the last."""
        options = [word.split("=")[0] for word in sys.argv[1:] if word.startswith("--")]
        for option in options:
            if options.count(option) > 1:
                self.error(f"{option}: given twice; expected once")
        return super().parse_args()

    def begin(self, out):
        """Checks the prerequisites before the work begins: the program, and a directory to write to."""
        if shutil.which(CURBLINE) is None:
            self.error(f"{CURBLINE}: no program; expected tools/build to have made it, or CURBLINE to name another")
        try:
            os.makedirs(out, exist_ok=True)
        except OSError as error:
            self.error(f"--out {out}: {error.strerror}; expected a directory to write to")

    def error(self, message):
        self.exit(2, f"{self.prog}: {message}\n")


def number(kind, lowest, highest):
    """The range of an argument, for argparse."""
    def read(word):
        try:
            value = kind(word)
        except ValueError:
            value = None
        if value is None or not lowest <= value <= highest:
            raise argparse.ArgumentTypeError(f"{word}; expected a number from {lowest} to {highest}")
        return value
    return read


def script(main):
    """Runs a script. A failure is reported in one line, with exit status 1, or 130 if interrupted."""
    try:
        try:
            main()
        finally:
            print(end="", flush=True)  # flush here, where a full disk can be reported
    except KeyboardInterrupt:
        status, why = 130, "interrupted"
    except OSError as error:
        status, why = 1, f"{error.filename or 'standard output'}: {error.strerror}"
    else:
        return
    print(f"{os.path.basename(sys.argv[0])}: {why}", file=sys.stderr)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # discards what Python still buffers, whose write would fail again
    sys.exit(status)


@contextlib.contextmanager
def whole_file(path):
    """A file to write, which appears at PATH only when it is complete: until then, or on failure, an earlier one stays."""
    part = path + ".part"
    try:
        with open(part, "w") as file:
            yield file
        os.replace(part, path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            os.unlink(part)
        if isinstance(error, OSError) and error.filename in (None, part):
            error.filename = path
        raise


def failed(error, status, words):
    """Ends the script after curbline has failed with a message."""
    why = error.strip()
    sys.exit(f"{why}{': ' if why else ''}exit status {status} of curbline {' '.join(words)}")


def run(*words):
    """Runs curbline to its end and returns its standard output. Ends the script if it fails."""
    done = subprocess.run([CURBLINE, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        failed(done.stderr, done.returncode, words)
    print(end=done.stderr, file=sys.stderr, flush=True)
    return done.stdout


def parsed(text, words):
    """Parses the output of curbline --json. Ends the script if it is not JSON."""
    try:
        return json.loads(text)
    except ValueError:
        sys.exit(f"{CURBLINE} {' '.join(words)}: no JSON on its standard output; expected curbline")


def run_json(*words):
    return parsed(run(*words, "--json"), words)


def robot(name):
    return os.path.join(ROOT, "tools", "robots", name + ".toml")


def late_robot(laser, directory, errors):
    """Writes the shipped robot with these lines in its [simulated] to DIRECTORY/late.toml; returns the path."""
    with open(robot(laser)) as file:
        text = file.read()
    if "[simulated]\n" not in text:
        sys.exit(f"{robot(laser)}: no [simulated]; expected that table, to state the errors in")
    path = os.path.join(directory, "late.toml")
    with whole_file(path) as file:
        file.write(text.replace("[simulated]\n", f"[simulated]\n{errors}\n"))
    return path


def mean(values, weights=None):
    """The mean of the values that are not None, or None if there are none."""
    pairs = [(v, w) for v, w in zip(values, weights or [1] * len(values)) if v is not None and w > 0]
    return sum(v * w for v, w in pairs) / sum(w for _, w in pairs) if pairs else None


def shown(value, scale, decimals, width=10):
    """A figure of a table, or a dash if it is missing."""
    return f"{'-':>{width}}" if value is None else f"{scale * value:{width}.{decimals}f}"
