"""Every dependency's licence must be one that deny.toml allows, and every one comes from crates.io.

It stands in for `cargo deny check licenses sources` where that is not installed; both read the same list.
Usage: licences.py RTC ROOT.
"""

import json
import re
import subprocess
import sys
import tomllib

ROOT = sys.argv[2]
CRATES_IO = "registry+https://github.com/rust-lang/crates.io-index"


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


def main():
    with open(f"{ROOT}/deny.toml", "rb") as file:
        licences = set(tomllib.load(file)["licenses"]["allow"])
    command = ["cargo", "metadata", "--format-version", "1", "--locked"]
    metadata = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    packages = [package for package in json.loads(metadata)["packages"] if package["source"]]
    wrong = [
        f"{package['name']} {package['version']}: {package['license']}, from {package['source']}"
        for package in packages
        if package["source"] != CRATES_IO or not allowed(package["license"] or "none", licences)
    ]
    print(f"  {len(packages)} packages, {len(wrong)} not allowed")
    sys.exit("\n".join(wrong) or None)


main()
