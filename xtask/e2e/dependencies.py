"""What others wrote, and how it comes here: licences, sources, bans, checksums, yanked versions, advisories.

Holds what deny.toml says where cargo-deny is not installed; both read the same file. Each Cargo.lock of the repository is
looked at, also those of the fuzz targets and of what editors compile. Known advisories are looked for where there is a copy of
RustSec's database, which no package registry has: RTC_ADVISORIES names it, or it lies where `cargo audit` puts it.

Usage: dependencies.py RTC ROOT, in an empty folder.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(sys.argv[2])
CRATES_IO = "registry+https://github.com/rust-lang/crates.io-index"
NPM = "https://registry.npmjs.org/"
# Built and run only by who works on the project, so what they are made of is not given to anybody.
TOOLS = {"fuzz", "editors/tree-sitter-rt/generator"}


def read(path):
    with open(ROOT / path, "rb") as file:
        return tomllib.load(file)


def tracked(name):
    """The folders in which git knows a file of that name."""
    listed = subprocess.run(["git", "ls-files", "-z", name, f"**/{name}"], cwd=ROOT, check=True, capture_output=True, text=True)
    return sorted({str(pathlib.PurePath(path).parent) for path in listed.stdout.split("\0") if path})


def allowed(expression, licences):
    """Whether an SPDX expression of AND, OR, WITH and brackets can be met with these licences."""
    tokens = re.findall(r"[()]|[^\s()]+", expression.replace("/", " OR "))
    words = {"AND": "and", "OR": "or", "(": "(", ")": ")"}
    # `A WITH exception` is a licence of its own.
    joined = []
    for token in tokens:
        if joined and (token == "WITH" or joined[-1].endswith(" WITH")):
            joined[-1] += " " + token
        else:
            joined.append(token)
    python = " ".join(words.get(token, str(token in licences)) for token in joined)
    return eval(python, {"__builtins__": {}})


def graph_slips(folder, deny):
    """What a workspace's graph of packages has that deny.toml refuses."""
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--all-features"]
    made = subprocess.run(command, cwd=ROOT / folder, capture_output=True, text=True)
    if made.returncode:
        return 0, [f"{folder}: cargo metadata: {made.stderr.strip()}"]
    metadata = json.loads(made.stdout)
    packages = {package["id"]: package for package in metadata["packages"]}
    label = lambda package: f"{folder}: {package['name']} {package['version']}"
    licences, slips = set(deny["licenses"]["allow"]), []
    for package in packages.values():
        source = package["source"]
        if source not in (None, CRATES_IO):
            slips.append(f"{label(package)} is from {source}")
        if source and folder not in TOOLS and not allowed(package["license"] or "none", licences):
            slips.append(f"{label(package)} has the licence {package['license']}")
        # Of others, what their tests want is never built here.
        wanted = [need for need in package["dependencies"] if need["kind"] != "dev" or not source]
        for need in wanted:
            if need["req"] == "*" and "path" not in need:
                slips.append(f"{label(package)} takes any version of {need['name']}")
    bans = {ban["crate"]: ban for ban in deny["bans"]["deny"]}
    for node in metadata["resolve"]["nodes"]:
        for need in node["deps"]:
            ban = bans.get(packages[need["pkg"]]["name"])
            if ban and packages[node["id"]]["name"] not in ban.get("wrappers", []):
                slips.append(f"{label(packages[node['id']])} uses {ban['crate']}: {ban['reason']}")
    return len(packages), slips


def lock_slips(folder):
    """What a Cargo.lock does not pin."""
    return [
        f"{folder}: {package['name']} {package['version']} has no checksum"
        for package in read(f"{folder}/Cargo.lock")["package"]
        if package.get("source") == CRATES_IO and not re.fullmatch(r"[0-9a-f]{64}", package.get("checksum", ""))
    ]


def npm_slips(folder):
    """What a package-lock.json does not pin, or has from elsewhere."""
    lock = json.loads((ROOT / folder / "package-lock.json").read_text())
    others = {name: package for name, package in lock["packages"].items() if name}
    return len(others), [
        f"{folder}: {name} is from {package.get('resolved')} with the checksum {package.get('integrity')}"
        for name, package in others.items()
        # Where none is named it is npm's own registry.
        if not (package.get("resolved", NPM).startswith(NPM) and package.get("integrity", "").startswith("sha512-"))
    ]


def python_slips():
    """Packages of PyPI that are asked for without a version."""
    text = (ROOT / "xtask/src/tools.rs").read_text()
    lists = re.findall(r"(?:python\(folder, [^;]*?&|let packages = )\[([^\]]*)\]", text)
    names = [name for names in lists for name in re.findall(r'"([^"]+)"', names)]
    if not names:
        return 0, ["xtask/src/tools.rs: no packages of PyPI were found to look at"]
    return len(names), [f"xtask/src/tools.rs: {name} has no version" for name in names if "==" not in name]


def yanked_slips(folder):
    """Versions that their makers took back. Cargo asks crates.io: where no lock has them, it takes none of these."""
    wanted = [package for package in read(f"{folder}/Cargo.lock")["package"] if package.get("source") == CRATES_IO]
    lines = [
        f'dep{i} = {{ package = "{package["name"]}", version = "={package["version"]}", default-features = false }}'
        for i, package in enumerate(wanted)
    ]
    desk = pathlib.Path(folder.replace("/", "-") if folder != "." else "root")
    (desk / "src").mkdir(parents=True)
    (desk / "src/lib.rs").touch()
    head = ["[package]", 'name = "all-that-is-locked"', 'edition = "2024"', "[workspace]", "[dependencies]"]
    (desk / "Cargo.toml").write_text("\n".join(head + lines))
    made = subprocess.run(["cargo", "generate-lockfile"], cwd=desk, capture_output=True, text=True)
    return [f"{folder}: a version is yanked, or crates.io cannot be asked:\n{made.stderr.strip()}"] if made.returncode else []


def advisories():
    """Where RustSec's database lies, if it is here."""
    home = pathlib.Path(os.environ.get("CARGO_HOME") or pathlib.Path.home() / ".cargo")
    places = [pathlib.Path(place) for place in [os.environ.get("RTC_ADVISORIES")] if place] or [home / "advisory-db"]
    return next((place for place in places if (place / "crates").is_dir()), None)


def advisory_slips(database, folders, ignored):
    """Locked versions with a known flaw, or that nobody keeps any more."""
    locked = {}
    for folder in folders:
        for package in read(f"{folder}/Cargo.lock")["package"]:
            if package.get("source") == CRATES_IO:
                locked.setdefault(package["name"], {}).setdefault(package["version"], folder)
    slips = []
    for name, versions in locked.items():
        for path in sorted((database / "crates" / name).glob("*.md")):
            text = path.read_text()
            advice = tomllib.loads(text.split("```toml\n", 1)[1].split("```", 1)[0])
            about, safe = advice["advisory"], advice["versions"]
            if "withdrawn" in about or about["id"] in ignored:
                continue
            ranges = safe.get("patched", []) + safe.get("unaffected", [])
            for version, folder in versions.items():
                if not any(within(version, one) for one in ranges):
                    title = re.search(r"^# (.*)", text, re.M)
                    slips.append(f"{folder}: {name} {version}: {about['id']}, {title.group(1) if title else ''}")
    return slips


def within(version, ranges):
    """Whether a version meets all of the comparisons, as Cargo reads them, of a version without a suffix."""
    number = lambda text: tuple(int(part) for part in re.split(r"[-+]", text)[0].split("."))
    full = lambda parts: parts + (0,) * (3 - len(parts))
    has = full(number(version))
    for one in ranges.split(","):
        sign, text = re.fullmatch(r"\s*(>=|<=|>|<|=|\^|~)?\s*([0-9][^\s]*)\s*", one).groups()
        given = number(text)
        low = full(given)
        # Without a sign it is a caret: what the first number that is not 0 allows.
        place = next((i for i, part in enumerate(given) if part), len(given) - 1)
        place = min(1, len(given) - 1) if sign == "~" else len(given) - 1 if sign == "=" else place
        above = full(given[:place] + (given[place] + 1,))
        met = {">=": has >= low, "<=": has <= low, ">": has > low, "<": has < low}.get(sign, low <= has < above)
        if not met:
            return False
    return True


def main():
    deny = read("deny.toml")
    folders = tracked("Cargo.lock")
    slips = []
    for folder in folders:
        count, found = graph_slips(folder, deny)
        slips += found + lock_slips(folder) + yanked_slips(folder)
        print(f"  {folder}: {count} packages of Rust")
    for folder in tracked("package-lock.json"):
        count, found = npm_slips(folder)
        slips += found
        print(f"  {folder}: {count} packages of npm")
    count, found = python_slips()
    slips += found
    print(f"  {count} packages of PyPI")
    database = advisories()
    if database:
        ignored = {entry["id"] for entry in deny["advisories"]["ignore"]}
        found = advisory_slips(database, folders, ignored)
        slips += found
        print(f"  advisories of {database}: {len(found)} of what is locked")
    else:
        print("  no advisories were asked: there is no copy of RustSec's database, see deny.toml")
    sys.exit("\n".join(slips) or None)


main()
