#!/usr/bin/python3
"""The pages of README.md and docs/ as a site to be read offline.

    scripts/site.py [DIR]        default: build/site; begin with DIR/index.html

Needs Debian's python3-markdown.
"""
import html
import pathlib
import re
import shutil
import sys

import markdown

ROOT = pathlib.Path(__file__).resolve().parent.parent
CONTENTS = {
    "Start": ["README.md", "docs/tutorial.md", "docs/howto.md", "docs/gallery.md"],
    "Reference": ["docs/scene.md", "docs/output.md", "docs/studies.md", "docs/figures.md", "docs/models.md", "docs/plan.md", "docs/python.md"],
    "Physics": ["docs/physics.md", "docs/geometry.md", "docs/theory.md", "docs/glossary.md"],
    "How good": ["docs/accuracy.md", "docs/verification.md", "docs/trade.md", "docs/limits.md", "docs/thesis.md",
                 "docs/reliability.md", "perf/README.md"],
    "Building on it": ["docs/development.md", "docs/extending.md", "docs/packaging.md", "kernels/README.md"],
}
STYLE = """
:root { --text: #222; --faint: #667; --line: #d8dbe2; --page: #fff; --side: #f5f6f8; --link: #0b5cad }
@media (prefers-color-scheme: dark) {
  :root { --text: #dde; --faint: #99a; --line: #3a3d46; --page: #16181d; --side: #1d2026; --link: #79b4f2 }
}
* { box-sizing: border-box }
body { margin: 0; display: flex; color: var(--text); background: var(--page); font: 16px/1.55 system-ui, sans-serif }
nav { flex: 0 0 14rem; padding: 1.5rem 1rem; background: var(--side); border-right: 1px solid var(--line); min-height: 100vh }
nav h2 { margin: 1.2rem 0 .3rem; font-size: .8rem; color: var(--faint); text-transform: uppercase }
nav a { display: block; padding: .1rem 0; text-decoration: none }
nav a.here { font-weight: 600; color: var(--text) }
main { flex: 1 1 auto; min-width: 0; max-width: 62rem; padding: 1.5rem 2.5rem 4rem }
a { color: var(--link) }
img { max-width: 100%; background: #fff }
h1, h2, h3 { line-height: 1.25 }
code { font: .88em/1.4 ui-monospace, monospace; background: var(--side); padding: .1em .25em; border-radius: 3px }
pre { background: var(--side); border: 1px solid var(--line); padding: .8rem 1rem; overflow-x: auto }
pre code { padding: 0; background: none }
.wide { overflow-x: auto }
table { border-collapse: collapse; font-size: .93em }
th, td { border-bottom: 1px solid var(--line); padding: .35rem .8rem .35rem 0; text-align: left; vertical-align: top }
@media (max-width: 50rem) {
  body { display: block }
  nav { min-height: 0; border-right: 0; border-bottom: 1px solid var(--line) }
  nav a { display: inline-block; margin-right: .8rem }
  main { padding: 1rem }
}
@media print { nav { display: none } }
"""


def title_of(page):
    return re.search(r"^# (.*)$", page.read_text(encoding="utf-8"), flags=re.M)[1]


def name_of(page):
    """Of a page in the site."""
    path = page.relative_to(ROOT)
    if path == pathlib.Path("README.md"):
        return "index.html"
    return (path.name if path.parent.name == "docs" else f"{path.parent.name}.md").replace(".md", ".html")


def slug(text, separator):
    """As GitHub makes them of headings, for links into pages."""
    return re.sub(r"[^\w\- ]", "", text.lower()).strip().replace(" ", separator)


def body_of(page, pages, out):
    text = page.read_text(encoding="utf-8")
    # A table or a list may follow a line of text directly.
    text = re.sub(r"^([^|\n].*)\n(\|)", r"\1\n\n\2", text, flags=re.M)
    text = re.sub(r"^((?![*\-] |\s|\d+\. ).+)\n([*\-] |1\. )", r"\1\n\n\2", text, flags=re.M)
    body = markdown.markdown(text, extensions=["tables", "fenced_code", "toc", "sane_lists"],
                             extension_configs={"toc": {"slugify": slug}})

    def link(match):
        attribute, target = match[1], html.unescape(match[2])
        path, hash_, anchor = target.partition("#")
        if re.match(r"[a-z]+:", target) or not path:
            return match[0]
        file = (page.parent / path).resolve()
        if file in pages:
            return f'{attribute}="{pages[file]}{hash_}{anchor}"'
        copy = out / "files" / file.relative_to(ROOT)
        if file.is_dir():
            shutil.copytree(file, copy, dirs_exist_ok=True)
        else:
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, copy)
        return f'{attribute}="{html.escape(str(copy.relative_to(out)))}{hash_}{anchor}"'

    body = re.sub(r'(href|src)="([^"]*)"', link, body)
    return body.replace("<table>", '<div class="wide"><table>').replace("</table>", "</table></div>")


def main():
    out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build" / "site")
    groups = {group: [p for p in (ROOT / name for name in names) if p.exists()] for group, names in CONTENTS.items()}
    pages = {page: name_of(page) for names in groups.values() for page in names}
    missing = set((ROOT / "docs").glob("*.md")) - set(pages)
    if missing:
        sys.exit("not in the contents of scripts/site.py: " + ", ".join(sorted(p.name for p in missing)))
    out.mkdir(parents=True, exist_ok=True)
    for page in pages:
        nav = ""
        for group, names in groups.items():
            nav += f"<h2>{group}</h2>\n"
            for other in names:
                here = ' class="here"' if other == page else ""
                nav += f'<a{here} href="{pages[other]}">{html.escape(title_of(other))}</a>\n'
        (out / pages[page]).write_text(
            f'<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>{html.escape(title_of(page))}</title>\n<style>{STYLE}</style>\n"
            f"<nav>\n{nav}</nav>\n<main>\n{body_of(page, pages, out)}\n</main>\n</html>\n", encoding="utf-8")
    print(f"{out / 'index.html'}: {len(pages)} pages")


if __name__ == "__main__":
    main()
