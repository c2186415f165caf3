"""Checks of the source tree that no compiler makes.

usage: check_structure.py {arrows|lines|citations} ROOT

arrows     an include names a module that the including module may know (docs/architecture.md)
lines      no line of a source, script or build file is longer than 120 characters
citations  every key such as [Pin88] in a comment is in docs/references.md

Prints one line `file:line: reason` per finding; exits with 1 if there are any.
"""

import pathlib
import re
import sys

MAY_KNOW = {
    "core": set(),
    "mesh": {"core"},
    "scenes": {"core", "mesh"},
    "grouping": {"core", "mesh"},
    "raster": {"core"},
    "pipeline": {"core", "mesh", "scenes", "grouping", "raster"},
    "cli": {"core", "mesh", "scenes", "grouping", "raster", "pipeline"},
}
MAY_KNOW_ALL = {"tests", "bench"}
SOURCES = {".cpp", ".h"}
OTHERS = {".py", ".cmake", ".in", ".txt"}
LINE_LENGTH = 120

CITATION = re.compile(r"\[([A-Z][A-Za-z]*[0-9]{2}|H99|PG|LG|HFC)\]")
INCLUDE = re.compile(r'\s*#\s*include\s*["<]([^">]+)[">]')


def files_of(root):
    """Every file of the project below root, as paths relative to it."""
    for folder in sorted([*MAY_KNOW, *MAY_KNOW_ALL, "cmake", "scripts", ".ci"]):
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                yield path.relative_to(root)
    yield pathlib.Path("CMakeLists.txt")


def lines_of(root, path):
    return enumerate((root / path).read_text(encoding="utf-8").splitlines(), start=1)


def find_wrong_arrows(root):
    for path in files_of(root):
        module = path.parts[0]
        if path.suffix not in SOURCES or module not in MAY_KNOW:
            continue
        for number, line in lines_of(root, path):
            match = INCLUDE.match(line)
            if not match:
                continue
            included = match.group(1)
            target = included.split("/")[0]
            if "/" not in included and (root / path.parent / included).exists():
                yield f'{path}:{number}: "{included}" must be included from the root, as "{module}/{included}"'
            elif included.startswith("."):
                yield f'{path}:{number}: "{included}" must be included from the root'
            elif target in MAY_KNOW.keys() | MAY_KNOW_ALL and target != module and target not in MAY_KNOW[module]:
                yield f"{path}:{number}: {module} must not know {target}"


def find_long_lines(root):
    for path in files_of(root):
        if path.suffix in SOURCES | OTHERS or path.parts[0] in {"scripts", ".ci"}:
            for number, line in lines_of(root, path):
                if len(line) > LINE_LENGTH:
                    yield f"{path}:{number}: {len(line)} characters, at most {LINE_LENGTH}"


def find_unknown_citations(root):
    known = set(re.findall(r"\*\*\[(\w+)\]\*\*", (root / "docs/references.md").read_text(encoding="utf-8")))
    for path in files_of(root):
        if path.suffix not in SOURCES:
            continue
        for number, line in lines_of(root, path):
            for key in CITATION.findall(line.partition("//")[2]):
                if key not in known:
                    yield f"{path}:{number}: [{key}] is not in docs/references.md"


CHECKS = {"arrows": find_wrong_arrows, "lines": find_long_lines, "citations": find_unknown_citations}


def main(arguments):
    if len(arguments) != 2 or arguments[0] not in CHECKS:
        sys.exit(__doc__)
    root = pathlib.Path(arguments[1])
    if not (root / "CMakeLists.txt").is_file():
        sys.exit(f"{root}: not the root of the project")
    findings = list(CHECKS[arguments[0]](root))
    for finding in findings:
        print(finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
