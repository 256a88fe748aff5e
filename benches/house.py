#!/usr/bin/env python3
"""How the code reads, counted: names of types, methods of the largest type, comments, arguments.

    benches/house.py [--list WHAT] [FOLDER]

Counts the sources of the crates without their tests. `--list` prints what a figure counts: `one-word`, `participles`,
`shared`, `arguments`, `methods` or `comments` (by crate).
"""

import argparse
import collections
import pathlib
import re

IRREGULAR = {
    "Begun", "Beaten", "Bent", "Bound", "Broken", "Brought", "Built", "Caught", "Chosen", "Come", "Cut", "Done", "Drawn",
    "Driven", "Found", "Given", "Gone", "Grown", "Held", "Kept", "Known", "Laid", "Left", "Lost", "Made", "Met", "Read",
    "Said", "Seen", "Sent", "Set", "Shown", "Split", "Spoken", "Spread", "Taken", "Thought", "Told", "Understood", "Worn",
    "Written",
}
NOT_PARTICIPLES = {"Bed", "Feed", "Need", "Seed", "Shed", "Speed", "Weed"}


def sources(folder):
    """Sources without tests: path -> text up to the tests inside it."""
    found = {}
    for path in sorted(folder.glob("**/*.rs")):
        parts = path.relative_to(folder).parts
        if parts[0] in ("target", "tests", "examples", "benches") or any("tests" in p for p in parts):
            continue
        if parts[-1] == "build.rs":
            continue
        found[path.relative_to(folder)] = re.split(r"#\[cfg\(test\)\]\n\s*mod \w+ \{", path.read_text())[0]
    return found


def code_of(text):
    """The lines that are neither empty nor comments, and how many are of each kind of comment."""
    lines = [line.strip() for line in text.splitlines()]
    docs = sum(line.startswith(("///", "//!")) for line in lines)
    comments = sum(line.startswith("//") for line in lines) - docs
    code = [line for line in lines if line and not line.startswith("//")]
    return code, docs, comments


def types_of(text):
    return re.findall(r"^\s*(?:pub(?:\([^)]*\))? )?(?:struct|enum|union|trait|type) (\w+)", text, re.M)


def words(name):
    return re.findall(r"[A-Z]+(?![a-z])|[A-Z][a-z0-9]*", name)


def is_participle(name):
    last = words(name)[-1:] == [name]
    return last and name not in NOT_PARTICIPLES and (name in IRREGULAR or name.endswith("ed"))


def methods_of(texts):
    """Methods by type, of all its `impl` blocks that are no trait's."""
    found = collections.Counter()
    for path, text in texts.items():
        crate = path.parts[1] if path.parts[0] == "crates" else "front"
        for name, body in re.findall(r"^impl(?:<[^{]*?>)? (\w+)(?:<[^{]*>)? \{\n(.*?)^\}", text, re.S | re.M):
            count = len(re.findall(r"^    (?:pub(?:\([^)]*\))? )?(?:const |unsafe )*fn ", body, re.M))
            found[f"{crate}::{name}"] += count
    return found


def arguments_of(text):
    """Names of functions with the numbers of their arguments, `self` included."""
    # what a standard or C calls has the arguments that these give it
    text = re.sub(r'extern "C" fn \w+', "", re.sub(r"//.*", "", text))
    for match in re.finditer(r"\bfn (\w+)(?:<[^(]*>)?\(", text):
        depth, start, count, i = 1, match.end(), 0, match.end()
        while depth and i < len(text):
            c = text[i]
            if c in "([{<":
                depth += 1
            elif c in ")]}" or (c == ">" and text[i - 1] != "-"):
                depth -= 1
            elif c == "," and depth == 1:
                count += 1
            i += 1
        inside = text[start : i - 1].strip()
        yield match.group(1), 0 if not inside else count + (not inside.endswith(","))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[1])
    parser.add_argument("--list", dest="what")
    args = parser.parse_args()
    texts = sources(args.folder)
    names = [(name, path) for path, text in texts.items() for name in types_of(text)]
    often = collections.Counter(name for name, _ in names)
    figures = {
        "one-word": [n for n in names if len(words(n[0])) <= 1],
        "participles": [n for n in names if is_participle(n[0])],
        "shared": [n for n in names if often[n[0]] > 1],
    }
    functions = [(name, count, path) for path, text in texts.items() for name, count in arguments_of(text)]
    many = [f for f in functions if f[1] >= 6]
    methods = methods_of(texts)
    by_crate = collections.defaultdict(lambda: [0, 0, 0])
    for path, text in texts.items():
        crate = path.parts[1] if path.parts[0] == "crates" else path.parts[0]
        code, docs, comments = code_of(text)
        for i, n in enumerate((len(code), docs, comments)):
            by_crate[crate][i] += n
    code, docs, comments = (sum(c[i] for c in by_crate.values()) for i in range(3))
    if args.what in figures:
        for name, path in sorted(figures[args.what]):
            print(f"{name:28} {path}")
    elif args.what == "arguments":
        for name, count, path in sorted(many, key=lambda f: -f[1]):
            print(f"{count:3} {name:32} {path}")
    elif args.what == "methods":
        for name, count in methods.most_common(20):
            print(f"{count:4} {name}")
    elif args.what == "comments":
        for crate, (c, d, w) in sorted(by_crate.items()):
            print(f"{crate:10} {c:6} lines of code  docs {100 * d / c:5.1f}  comments {100 * w / c:4.1f}")
    else:
        largest, count = methods.most_common(1)[0]
        print(f"lines of code                       {code}")
        print(f"largest type                        {largest}: {count} methods")
        for what, found in figures.items():
            print(f"types: {what:12}                 {100 * len(found) / len(names):.1f} % of {len(names)}")
        print(f"documentation per 100 lines of code {100 * docs / code:.1f}")
        print(f"comments per 100 lines of code      {100 * comments / code:.1f}")
        print(f"functions with 6 or more arguments  {100 * len(many) / len(functions):.1f} % of {len(functions)}")
        print(f"most arguments                      {max(f[1] for f in functions)}")


if __name__ == "__main__":
    main()
