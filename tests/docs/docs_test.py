#!/usr/bin/env python3
"""What the pages say can be done: links lead somewhere, commands are known and their scenes sound, Python blocks run.

    docs_test.py HOURGLASS
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.path.abspath(sys.argv.pop(1))
ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = sorted(p for folder in (".", "docs", "kernels", "perf") for p in ROOT.glob(f"{folder}/*.md"))


def text_of(page):
    return page.read_text(encoding="utf-8")


def without_code(text):
    return re.sub(r"^```.*?^```|^    .*?$", "", text, flags=re.M | re.S)


def anchors(page):
    """As GitHub and pandoc's gfm make them of headings."""
    names = set()
    for heading in re.findall(r"^#+ (.*)$", without_code(text_of(page)), flags=re.M):
        name = re.sub(r"[^\w\- ]", "", re.sub(r"[`*]", "", heading).lower()).strip().replace(" ", "-")
        names.add(name)
    return names


def blocks(page, language):
    return re.findall(rf"^```{language}\n(.*?)^```", text_of(page), flags=re.M | re.S)


def commands(page):
    """The lines of a page's code that call hourglass, as lists of words; a line that ends in \\ goes on."""
    text = text_of(page).replace("\\\n", " ")
    code = re.findall(r"^```(?:bash|sh)?\n(.*?)^```", text, flags=re.M | re.S) + re.findall(r"^    (\S.*)$", text, flags=re.M)
    for line in "\n".join(code).splitlines():
        found = re.match(r"\s*(?:\$ )?(?:\./)?hourglass (?=[a-z])(.*)", line)
        if found:
            yield shlex.split(found[1], comments=True)


def hourglass(*arguments, cwd=ROOT):
    return subprocess.run([PROGRAM, *arguments], cwd=cwd, capture_output=True, text=True, timeout=300)


def is_placeholder(word):
    return word.isupper() or word.split(".")[0].isupper() or "..." in word or word.startswith("[")


class Docs(unittest.TestCase):
    def test_links(self):
        self.assertGreater(len(PAGES), 15)
        broken = []
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)\)", without_code(text_of(page))):
                if re.match(r"[a-z]+:", target):
                    continue
                path, _, anchor = target.partition("#")
                file = (page.parent / path).resolve() if path else page
                if not file.exists():
                    broken.append(f"{page.name}: {target}")
                elif anchor and file.suffix == ".md" and anchor not in anchors(file):
                    broken.append(f"{page.name}: {target} (no such heading)")
        self.assertEqual(broken, [])

    def test_every_page_can_be_reached_from_the_readme(self):
        reached, todo = set(), [ROOT / "README.md"]
        while todo:
            page = todo.pop()
            if page in reached or not page.exists():
                continue
            reached.add(page)
            for target in re.findall(r"\]\(([^)#\s]+\.md)", text_of(page)):
                todo.append((page.parent / target).resolve())
        self.assertEqual([p.name for p in PAGES if p not in reached], [])

    def test_commands(self):
        count = 0
        helps = {}
        for page in PAGES:
            for words in commands(page):
                with self.subTest(page=page.name, command=" ".join(words)):
                    count += 1
                    command, rest = words[0], words[1:]
                    if command not in helps:
                        helps[command] = hourglass(command, "--help")
                    self.assertEqual(helps[command].returncode, 0, f"no command {command}")
                    for word in rest:
                        option = word.strip("[]").split("=")[0]
                        if option.startswith("--"):
                            self.assertRegex(helps[command].stdout, rf"{option}\b", f"{command} has no {option}")
                    files = [w for w in rest if w.endswith(".yaml") and not is_placeholder(w)]
                    if any(is_placeholder(w) for w in rest):
                        continue
                    for file in files:
                        self.assertTrue((ROOT / file).exists(), file)
                    if command in ("run", "plan", "check", "trade", "limits") and files:
                        sets = [w for k, w in enumerate(rest) if w == "--set" or (k and rest[k - 1] == "--set")]
                        result = hourglass("check", files[0], *sets)
                        self.assertEqual(result.returncode, 0, result.stderr)
                    if command == "sweep" and files:
                        result = hourglass("sweep", files[0], "--dry-run")
                        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreater(count, 10)

    def test_python_page(self):
        page = ROOT / "docs" / "python.md"
        run = next(words for words in commands(page) if words[0] == "run")
        with tempfile.TemporaryDirectory() as folder:
            result = hourglass(*run, "--quiet", "--out", f"{folder}/runs/silo", "--set", "output.snapshots_every=0")
            self.assertEqual(result.returncode, 0, result.stderr)
            code = "\n".join(blocks(page, "python"))
            self.assertGreater(code.count("import"), 2)
            # Debian's interpreter, for which packages.txt brings h5py and meshio.
            said = subprocess.run(["/usr/bin/python3", "-c", code], cwd=folder, capture_output=True, text=True, timeout=120)
            self.assertEqual(said.returncode, 0, said.stderr)
            out = said.stdout
            rate = float(re.search(r"([\d.]+) rho sqrt", out)[1])
            self.assertAlmostEqual(rate, 84, delta=4)  # the base silo at 64 cells
            lost, through = map(float, re.search(r"lost (\d+), counted at the orifice (\d+)", out).groups())
            self.assertAlmostEqual(lost / through, 1, delta=2e-3)
            self.assertIn("'grains'", out)
            self.assertRegex(out, r"of the grains stand still")


if __name__ == "__main__":
    unittest.main(verbosity=1)
