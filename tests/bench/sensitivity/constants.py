"""The named constants of the product's sources: which are tuned, and why the others are not (not_tuned.txt)."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[3]
ROOMS = ("base", "rfs_mesh", "smoothing", "pipeline", "include")
DECLARATION = re.compile(r"(?P<storage>(?:inline |static )*)constexpr (?P<type>[\w:<>, ]+?) (?P<names>k[A-Z][^;]*);(?P<rest>[^\n]*)")
NAME = re.compile(r"\s*(?P<name>k[A-Z]\w*)(?:\[\d+\])*(?: = |\s+=\s+|(?=\{))(?P<value>.*)", re.DOTALL)
LITERAL = re.compile(r"(?<![\w.])-?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[FfuU]*(?![\w.])")


class Constant:
    """One number, or one row of numbers, with a name."""

    def __init__(self, path, name, value, origin):
        self.path, self.name, self.value, self.origin = path, name, " ".join(value.split()), origin
        self.key = f"{path}:{name}"

    def numbers(self):
        """How many: each of an array is one."""
        return len(LITERAL.findall(self.value)) if "{" in self.value else 1


def sources():
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("*")):
            if path.suffix in (".h", ".hpp", ".cpp"):
                yield path


def parts(text):
    """Split at commas outside of brackets."""
    depth, start = 0, 0
    for i, c in enumerate(text):
        depth += (c in "({[") - (c in ")}]")
        if c == "," and depth == 0:
            yield text[start:i]
            start = i + 1
    yield text[start:]


def origin_of(text, match):
    """The comment behind a declaration, or else the one above the declarations that it stands among."""
    behind = match["rest"].strip().lstrip("/<").strip()
    if behind:
        return behind
    above = text[:match.start()].split("\n")[:-1]
    while above and DECLARATION.search(above[-1]):
        above.pop()
    said = []
    while above and above[-1].strip().startswith("//"):
        said.insert(0, above.pop().strip().lstrip("/").strip())
    return " ".join(said)


def constants_in(path, text=None):
    """[(match of the declaration, its constants)]: numbers only, no words and no limits of types."""
    text = path.read_text() if text is None else text
    found = []
    for match in DECLARATION.finditer(text):
        of_it = [NAME.fullmatch(part) for part in parts(match["names"])]
        if not all(of_it) or re.search(r"""["']|numeric_limits|\(-1\)""", match["names"]) or "auto" in match["type"]:
            continue
        if any(not LITERAL.search(m["value"]) and not re.search(r"\bk[A-Z]", m["value"]) for m in of_it):
            continue
        origin = origin_of(text, match)
        found.append((match, [Constant(str(path.relative_to(ROOT)), m["name"], m["value"], origin) for m in of_it]))
    return found


def left_out():
    """[(class, reason, {key pattern})] of not_tuned.txt."""
    classes = []
    for line in (pathlib.Path(__file__).parent / "not_tuned.txt").read_text().split("\n"):
        if line.startswith("["):
            name, reason = line[1:].split("] ", 1)
            classes.append((name, reason, set()))
        elif line and not line.startswith("#"):
            path, names = line.split(": ")
            classes[-1][2].update(f"{path}:{name}" for name in names.split())
    return classes


def classified():
    """The tuned ones, and {class: (reason, constants)} of the others. An entry that fits nothing is an error."""
    classes = left_out()
    tuned, others = [], {name: (reason, []) for name, reason, _ in classes if name != "sized"}
    used = set()
    for path in sources():
        for _, of_it in constants_in(path):
            for c in of_it:
                folder = c.path[:c.path.rfind("/") + 1]
                patterns = {c.key, f"{c.path}:*"} | {f"{folder[:i + 1]}:*" for i, x in enumerate(folder) if x == "/"}
                of_class = [name for name, _, keys in classes if keys & patterns]
                used |= patterns
                c.sized = of_class == ["sized"]
                (others[of_class[0]][1] if of_class and not c.sized else tuned).append(c)
    stale = sorted(key for _, _, keys in classes for key in keys - used)
    if stale:
        raise SystemExit("not_tuned.txt: no such constant: " + ", ".join(stale))
    return tuned, others

