#!/usr/bin/env python3
"""Pages of `hourglass report` in a headless browser, at the width of a phone and of a desktop. Skipped without one."""
import html
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.path.abspath(sys.argv.pop(1))
BROWSER = next((path for path in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if path), None)
SKIPPED = 77
NASTY = "<img src=x onerror=parent.caught.push(1)> & \\\"two\\\" 'quotes'"

SCENE = """name: "%s"
domain: {width: 40, height: 40}
grid: {cells_x: 16}
materials:
  sand: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4}
  dyed: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4}
fill: [{material: sand, box: {x: [0, 40], y: [0, 30]}}, {material: dyed, box: {x: [0, 40], y: [10, 30]}}]
orifices: [{wall: bottom, centre: 10, width: 10}, {wall: bottom, centre: 30, width: 10}]
time: {end: 6}
output: {fields_every: 1, snapshots_every: 0, fields: [speed, tracer]}
""" % NASTY

# What a page does that should not; runs before anything else of it.
WATCH = """<script>
window.problems = [];
addEventListener('error', e => problems.push('error: ' + e.message));
addEventListener('securitypolicyviolation', e => problems.push('policy: ' + e.blockedURI));
console.error = (...words) => problems.push('console: ' + words.join(' '));
</script>"""

# Looks at a page in a frame of the given width and says what is wrong.
CHECK = """
window.caught = [];
const frame = document.querySelector('iframe'), pause = ms => new Promise(done => setTimeout(done, ms));
frame.addEventListener('load', async () => {
  const page = frame.contentDocument, inner = frame.contentWindow, wrong = [...inner.problems], told = {};
  const expect = (good, words) => { if (!good) wrong.push(words); };
  await pause(200);
  const width = frame.clientWidth;
  expect(page.documentElement.scrollWidth <= width, 'the page is ' + page.documentElement.scrollWidth + ' wide');
  for (const node of page.querySelectorAll('h1, h2, p, figure, svg, img, dl, .controls, .scroll, pre, summary')) {
    const box = node.getBoundingClientRect();
    if (box.width > 0 && !node.closest('.scroll') && box.right > width + 1) {
      wrong.push(node.tagName + '.' + node.className + ' ends at ' + box.right);
    }
  }
  for (const text of page.querySelectorAll('.chart text')) {
    const size = 15 * text.ownerSVGElement.getBoundingClientRect().width / 560;
    expect(size >= 8.5, 'letters of a chart are ' + size + ' px');
  }
  for (const viewer of page.querySelectorAll('.viewer')) {
    const slider = viewer.querySelector('input'), out = viewer.querySelector('output');
    const seen = () => [...viewer.querySelectorAll('img')].filter(image => image.offsetParent);
    const fields = viewer.querySelectorAll('.field');
    for (const field of fields) {
      field.click();
      for (const value of [0, slider.max]) {
        slider.value = value;
        slider.dispatchEvent(new inner.Event('input', {bubbles: true}));
        await pause(100);
        expect(seen().length === 1, seen().length + ' pictures at once');
        const image = seen()[0];
        expect(image.naturalWidth > 300, 'no picture');
        expect(image.alt.startsWith(field.textContent), 'alt: ' + image.alt);
        expect(out.textContent === image.dataset.caption && out.textContent, 'caption: ' + out.textContent);
      }
    }
    const last = out.textContent;
    viewer.querySelector('.back').click();
    expect(+slider.max === 0 || out.textContent !== last, 'a step back shows the same');
    viewer.querySelector('.on').click();
    expect(out.textContent === last, 'a step on is not the way back');
    viewer.querySelector('.play').click();
    await pause(700);
    expect(+slider.max === 0 || slider.value > 0 || viewer.querySelector('.play').textContent === 'Play', 'does not play');
    told.pictures = viewer.querySelectorAll('img').length;
    told.fields = fields.length;
  }
  const charts = page.querySelectorAll('.chart');
  for (const chart of charts) {
    const svg = chart.querySelector(':scope > svg');
    const points = JSON.parse(chart.querySelector('script').textContent).series.flatMap(s => s.points);
    expect(points.length > 0, 'an empty chart: ' + chart.textContent.slice(0, 40));
    if (!points.length) { continue; }
    const box = svg.getBoundingClientRect(), scale = box.width / 560, p = points[points.length >> 1];
    svg.dispatchEvent(new inner.PointerEvent('pointermove',
      {clientX: box.left + p[0] * scale, clientY: box.top + p[1] * scale, bubbles: true}));
    const tip = chart.querySelector('.tip');
    expect(!tip.hidden && /[0-9]/.test(tip.textContent), 'no value under the pointer');
  }
  told.charts = charts.length;
  for (const link of page.querySelectorAll('a[href^="#"]')) {
    expect(page.getElementById(link.getAttribute('href').slice(1)), 'a link to nowhere: ' + link.href);
  }
  const outside = inner.performance.getEntriesByType('resource').filter(e => !e.name.startsWith('data:'));
  expect(outside.length === 0, 'asks for ' + outside.map(e => e.name));
  wrong.push(...inner.problems.slice(0));
  expect(window.caught.length === 0, 'a name in the scene ran as a script');
  told.text = page.body.innerText;
  told.wrong = [...new Set(wrong)];
  const verdict = document.createElement('pre');
  verdict.id = 'verdict';
  verdict.textContent = JSON.stringify(told);
  document.body.append(verdict);
});
"""


def hourglass(*arguments, folder):
    return subprocess.run([PROGRAM, *arguments], cwd=folder, capture_output=True, text=True, timeout=300)


class ReportPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        with open(cls.path("scene.yaml"), "w") as file:
            file.write(SCENE)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    def run_scene(self, out, *sets):
        return hourglass("run", "scene.yaml", "--quiet", "--threads", "1", "--out", out,
                         *[word for s in sets for word in ("--set", s)], folder=self.folder.name)

    def report(self, folder):
        result = hourglass("report", folder, folder=self.folder.name)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.strip(), f"{folder}/report.html")
        with open(self.path(f"{folder}/report.html"), encoding="utf-8") as file:
            page = file.read()
        for target in re.findall(r'(?:src|href)="([^"]{0,20})', page):
            self.assertRegex(target, "^(data:|#)")
        return page

    def look_at(self, page, width):
        """What is wrong with it, and what is on it."""
        host = self.path("host.html")
        with open(host, "w", encoding="utf-8") as file:
            file.write(f'<!DOCTYPE html><meta charset="utf-8"><iframe style="width:{width}px;height:844px;border:0" srcdoc="'
                       + html.escape(page.replace("<head>", "<head>" + WATCH, 1)) + f'"></iframe><script>{CHECK}</script>')
        result = subprocess.run([BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=60000",
                                 f"--user-data-dir={self.path('profile')}", "--window-size=1400,900", "--dump-dom",
                                 "file://" + host], capture_output=True, text=True, timeout=240)
        found = re.search(r'<pre id="verdict">(.*?)</pre>', result.stdout, re.S)
        self.assertTrue(found, result.stderr[-2000:])
        verdict = json.loads(html.unescape(found[1]))
        self.assertEqual(verdict["wrong"], [], f"at {width} px")
        return verdict

    def test_a_run(self):
        result = self.run_scene("run")
        self.assertEqual(result.returncode, 0, result.stderr)
        page = self.report("run")
        self.assertLess(len(page), 8 << 20)
        for width in (390, 1280):
            seen = self.look_at(page, width)
            self.assertEqual((seen["fields"], seen["pictures"]), (2, 14))
            self.assertGreaterEqual(seen["charts"], 7)
            for words in ("<img src=x onerror", "dyed", "FINISHED", "discharge rate", "How to make it again",
                          "git checkout", "iterations of a step", "Where the time went"):
                self.assertIn(words, seen["text"])

    def test_a_run_that_failed_and_one_that_was_killed(self):
        self.run_scene("bad", "time.dt_max=5", "accuracy.backup_every=0", "accuracy.max_iterations=1",
                       "accuracy.pressure_tolerance=1e-14", "output.fields_every=0")
        with open(self.path("bad/summary.json")) as file:
            self.assertEqual(json.load(file)["status"], "diverged")
        seen = self.look_at(self.report("bad"), 390)
        for words in ("DIVERGED", "missed a tolerance", "stored neither fields nor snapshots"):
            self.assertIn(words, seen["text"])
        self.run_scene("killed")
        os.remove(self.path("killed/summary.json"))
        self.assertIn("NOT FINISHED", self.look_at(self.report("killed"), 390)["text"])
        with open(self.path("killed/series.csv"), "r+") as file:
            file.truncate(len(file.readline()))
        self.assertIn("before its first row", self.look_at(self.report("killed"), 390)["text"])

    def test_a_model(self):
        with open(self.path("model.yaml"), "w") as file:
            file.write(SCENE.replace('  dyed: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4}\n', "model: kinematic\n")
                       .replace(', {material: dyed, box: {x: [0, 40], y: [10, 30]}}', ""))
        result = hourglass("run", "model.yaml", "--quiet", "--out", "model", folder=self.folder.name)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("steady", self.look_at(self.report("model"), 390)["text"])

    def test_a_study(self):
        with open(self.path("study.yaml"), "w") as file:
            file.write('name: "widths & <i>"\nscene: scene.yaml\naxes: {width: [6, 8, 10, 12], end: [4, -1]}\n'
                       "set:\n  orifices.0.width: width\n  orifices.1.width: width\n  time.end: max(end, 3)\n"
                       "keep: fields\n")
        result = hourglass("sweep", "study.yaml", "--out", "study", folder=self.folder.name)
        self.assertEqual(result.returncode, 0, result.stderr)
        page = self.report("study")
        for width in (390, 1280):
            seen = self.look_at(page, width)
            self.assertGreaterEqual(seen["charts"], 3)
            for words in ("all 8 runs ended well", "k free: C = ", "0008"):
                self.assertIn(words, seen["text"])
        with open(self.path("study/results.csv"), "r+") as file:
            lines = file.readlines()
            file.seek(0)
            file.writelines(lines[:4])
            file.truncate()
        self.assertIn("3 of 8 runs have ended", self.look_at(self.report("study"), 390)["text"])

    def test_refusals(self):
        os.mkdir(self.path("empty"))
        result = hourglass("report", "empty", folder=self.folder.name)
        self.assertEqual(result.returncode, 2)
        self.assertIn("empty: holds neither a run (scene.yaml, series.csv) nor a sweep", result.stderr)
        self.assertEqual(os.listdir(self.path("empty")), [])


if __name__ == "__main__":
    if not BROWSER:
        print("skipped: no chromium on this machine")
        sys.exit(SKIPPED)
    unittest.main()
