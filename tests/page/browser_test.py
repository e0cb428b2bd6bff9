"""The page of `rfsmooth report` as people see it: in a browser.

browser_test.py COMMAND DRIVER CHROMIUM Page.NAME: runs one test.
"""
import math
import os
import random
import re
import struct
import subprocess
import sys
import tempfile
import unittest

from browser import Browser

COMMAND, DRIVER, CHROMIUM = (os.path.abspath(path) for path in sys.argv[1:4])
UTM = (500000.0, 4649776.5, 311.25)


def write_cloud(path, points):
    """Doubles, and as colour the number of the row."""
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
    header += "".join(f"property double {axis}\n" for axis in "xyz")
    header += "".join(f"property uchar {color}\n" for color in ("red", "green", "blue")) + "end_header\n"
    with open(path, "wb") as file:
        file.write(header.encode())
        for row, point in enumerate(points):
            file.write(struct.pack("<3d3B", *point, row & 255, row >> 8 & 255, row >> 16))


def waves(count, noise, origin=(0.0, 0.0, 0.0)):
    """A wavy sheet of 10 x 10, with and without noise: the same points."""
    source = random.Random(7)
    before, after = [], []
    for _ in range(count):
        x, y = source.uniform(0, 10), source.uniform(0, 10)
        clean = (x, y, math.sin(x) * math.cos(y))
        after.append(tuple(c + o for c, o in zip(clean, origin)))
        before.append((*after[-1][:2], after[-1][2] + source.gauss(0, noise)))
    return before, after


class Page(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def at(self, name):
        return os.path.join(self.folder, name)

    def make(self, before, after, *options, names=("before.ply", "after.ply")):
        """The page of two clouds: its path."""
        for name, points in zip(names, (before, after)):
            write_cloud(self.at(name), points)
        subprocess.run([COMMAND, "report", *names, "-o", "page.html", "--quiet", *options], cwd=self.folder, check=True)
        return self.at("page.html")

    def browse(self, page, ready="window.rfsmooth", **how):
        browser = Browser(DRIVER, CHROMIUM, self.at("profile"), **how)
        self.addCleanup(browser.close)
        browser.open(page)
        if ready:
            browser.wait_for(ready)
        return browser

    def set(self, browser, **state):
        browser.run("Object.assign(window.rfsmooth.state, arguments[0]); window.rfsmooth.paint();", state)

    def picture(self, browser):
        """The view once it rests: while something moves it is drawn of fewer points where drawing takes long."""
        browser.next_frame()
        browser.wait_for("rfsmooth.state.every === 1")
        return browser.picture("#view")

    def sides(self, browser):
        """The picture with all of it before, and all of it after."""
        pictures = []
        for slider in (1, 0):
            self.set(browser, slider=slider)
            pictures.append(self.picture(browser))
        return pictures

    def free(self, picture, border):
        """Places where only points are drawn: below the words, not at the border with its handle."""
        return [(x, y) for y in range(50, len(picture)) for x in range(30, len(picture[0]) - 30) if abs(x - border) > 30]

    def DecodedPointsAreTheFilesToHalfAQuantum(self):
        before, after = waves(9000, 0.05, UTM)
        for row in range(0, 9000, 90):
            before[row] = after[row] = (math.nan, 1.0, 2.0)
        for row in range(1, 9000, 180):
            before[row] = after[row] = tuple(c + 3 * row / 9000 for c in before[row])  # away from the sheet
        browser = self.browse(self.make(before, after, "--points", "all"))
        about = browser.run("return rfsmooth.about")
        colors = browser.run("return Array.from(rfsmooth.points.color)")
        rows = [colors[4 * i] | colors[4 * i + 1] << 8 | colors[4 * i + 2] << 16 for i in range(about["shown"])]
        self.assertEqual(sorted(rows), [row for row in range(9000) if not math.isnan(before[row][0])])
        self.assertGreaterEqual(len(about["blocks"]), 3)
        steps = [block["step"] for block in about["blocks"] for _ in range(block["count"])]
        units = [block["unit"] for block in about["blocks"] for _ in range(block["count"])]
        for side, (points, quanta) in enumerate([(before, steps), (after, units)]):
            decoded = browser.run("return Array.from(rfsmooth.coordinates(arguments[0]))", side)
            for i, row in enumerate(rows):
                for axis in range(3):
                    # Coordinates of a million are themselves rounded to 2^-33.
                    self.assertLessEqual(abs(decoded[3 * i + axis] - points[row][axis]), quanta[i] / 2 + 4e-9)
        self.assertLess(max(steps), 14 / 65535)
        self.assertLess(max(units), 0.3 / 127)

    def LeftOfTheSliderIsBeforeAndRightIsAfter(self):
        browser = self.browse(self.make(*waves(20000, 0.1)))
        before, after = self.sides(browser)
        width = len(before[0])
        differ = 0
        for share in (0.5, 0.3):
            self.set(browser, slider=share)
            both, border = self.picture(browser), share * width
            for x, y in self.free(both, border):
                alone = before if x < border else after
                self.assertEqual(both[y][x], alone[y][x], f"at {x}, {y} with the border at {border}")
                differ += before[y][x] != after[y][x]
        self.assertGreater(differ, 0.1 * width * len(before), "the sides look alike")

    def MovingTheSliderMovesTheBorder(self):
        browser = self.browse(self.make(*waves(20000, 0.1)))
        before, after = self.sides(browser)
        width = len(before[0])
        self.set(browser, slider=0.5)
        browser.pointer("mouse", ("#slider", [(0, 40), (-50, 40), (-120, 40)]))
        border = width / 2 - 120
        self.assertAlmostEqual(browser.run("return rfsmooth.state.slider"), border / width, delta=2 / width)
        picture = self.picture(browser)
        for x, y in self.free(picture, border):
            self.assertEqual(picture[y][x], (before if x < border else after)[y][x])
        for _ in range(3):
            browser.keys("#slider", "\ue014")  # arrow to the right
        self.assertAlmostEqual(browser.run("return rfsmooth.state.slider"), border / width + 0.06, delta=2 / width)
        browser.pointer("touch", ("#slider", [(0, 40), (60, 40)]))
        # The finger may land beside the middle, and its first pixels count as a tap.
        self.assertGreater(browser.run("return rfsmooth.state.slider"), border / width + 0.06 + 15 / width)

    def EveryModeShowsSomethingElse(self):
        before, after = waves(20000, 0.1)
        stray = [(5 + 0.4 * k, 5.0, 4 + 0.5 * k) for k in range(6)]
        browser = self.browse(self.make(before + stray, after + stray))
        self.assertEqual(browser.run("return rfsmooth.about.blocks.at(-1).count"), len(stray), "strays have a block of their own")
        pictures = []
        for mode in ("shaded", "colors", "moves", "outliers"):
            browser.click(f"input[value={mode}]")
            pictures.append(self.picture(browser))
            for earlier in pictures[:-1]:
                self.assertNotEqual(earlier, pictures[-1], mode)

        def red(picture):
            return sum(r > 150 and g < 60 and b < 60 for row in picture for r, g, b in row)
        with_strays = red(pictures[-1])
        browser.click("#strays")
        self.assertLess(red(self.picture(browser)), with_strays - 50, "strays can be left out")

    def WhereNoPointIsThePageIsWhite(self):
        browser = self.browse(self.make(*waves(3000, 0.1)))
        self.set(browser, mode="outliers", slider=1)  # all points are of one grey, darkened where others stand out
        picture = self.picture(browser)
        shades = {picture[y][x] for x, y in self.free(picture, -100)}
        self.assertIn((255, 255, 255), shades)
        self.assertGreater(len(shades), 20)
        self.assertEqual([shade for shade in shades if 200 <= shade[0] < 255], [])

    def WhatMovesIsDrawnOfFewerPointsAndAllOfThemWhenItRests(self):
        browser = self.browse(self.make(*waves(20000, 0.1)))
        whole = self.picture(browser)
        self.set(browser, frame=1e-3)  # no time at all
        browser.ask("POST", "/execute/async", {"args": [], "script": """
            const [done] = arguments, view = document.getElementById('view');
            view.dispatchEvent(new WheelEvent('wheel', {deltaY: 0, cancelable: true}));
            requestAnimationFrame(() => requestAnimationFrame(() => { window.moving = rfsmooth.state.every; done(); }));"""})
        self.assertEqual(browser.run("return moving"), 16)
        browser.wait_for("rfsmooth.state.every === 1")
        self.assertEqual(self.picture(browser), whole)

    def ACrossSectionShowsASlab(self):
        browser = self.browse(self.make(*waves(20000, 0.1)))
        whole = self.picture(browser)
        browser.run("const s = document.getElementById('section'); s.value = 'x'; s.dispatchEvent(new Event('change'));")
        slab = self.picture(browser)

        def drawn(picture):
            return sum(pixel != (255, 255, 255) for row in picture for pixel in row)
        self.assertLess(drawn(slab), drawn(whole) / 2)
        # The surface is a line there, and before a band around it.
        sides = [drawn(picture) for picture in self.sides(browser)]
        self.assertGreater(sides[0], 1.25 * sides[1])

    def KeysAndFingersMoveTheCamera(self):
        browser = self.browse(self.make(*waves(2000, 0.1)))

        def camera():
            return browser.run("const {turn, tilt, scale, target} = rfsmooth.camera; return {turn, tilt, scale, target}")
        first = camera()
        browser.keys("#view", "\ue012\ue013++")  # left, up
        moved = camera()
        for what in ("turn", "tilt"):
            self.assertNotAlmostEqual(first[what], moved[what], delta=0.05)
        self.assertAlmostEqual(moved["scale"] / first["scale"], 1.44, delta=1e-6)
        browser.keys("#view", "0")
        self.assertEqual(camera(), first)
        browser.pointer("touch", ("#view", [(-100, 100), (0, 100)]))
        self.assertAlmostEqual(abs(camera()["turn"] - first["turn"]), 0.5, delta=0.02)
        browser.keys("#view", "0")
        browser.pointer("touch", ("#view", [(-50, 50), (-100, 50)]), ("#view", [(50, 50), (100, 50)]))
        self.assertAlmostEqual(camera()["scale"] / first["scale"], 2, delta=0.1)
        self.assertAlmostEqual(camera()["turn"], first["turn"], delta=1e-9)

    def LoadsNothingAndComplainsOfNothing(self):
        browser = self.browse(self.make(*waves(5000, 0.1)))
        self.sides(browser)
        requests = [url for entry in browser.log("performance") for url in re.findall(
            r'"Network\.requestWillBeSent".*?"url":"([^"]*)"', entry["message"])]
        page = "file://" + self.at("page.html")
        self.assertEqual(requests[requests.index(page):], [page])  # before it: the browser's own first page
        self.assertEqual(browser.log("browser"), [])

    def NamesOfFilesAreText(self):
        names = ('<img src=x onerror="document.title=1">.ply', "{{points}}&amp;'</script><b>.ply".replace("/", "\u2215"))
        browser = self.browse(self.make(*waves(500, 0.1), names=names))
        self.assertEqual(browser.text("h1"), f"{names[0]} → {names[1]}")
        self.assertIn(names[0], browser.text("#command"))
        self.assertEqual(browser.run("return document.title"), f"{names[0]} → {names[1]}")
        self.assertEqual(browser.log("browser"), [])

    def ThePolicyForbidsEveryOtherScript(self):
        path = self.make(*waves(500, 0.1))
        with open(path, encoding="utf-8") as file:
            html = file.read()
        self.assertIn("default-src 'none'", html)
        with open(path, "w", encoding="utf-8") as file:
            file.write(html.replace("</main>", "<script>document.title = 'mine'</script></main>"))
        browser = self.browse(path)
        self.assertNotEqual(browser.run("return document.title"), "mine")

    def WithoutWebGlTheFiguresRemain(self):
        browser = self.browse(self.make(*waves(500, 0.1)), ready=None, arguments=["--disable-3d-apis"])
        self.figures_remain(browser)

    def WithoutScriptsTheFiguresRemain(self):
        browser = self.browse(self.make(*waves(500, 0.1)), ready=None,
                              preferences={"profile.managed_default_content_settings.javascript": 2})
        self.figures_remain(browser)

    def figures_remain(self, browser):
        self.assertTrue(browser.shown("#sorry"))
        self.assertFalse(browser.shown("#stage"))
        self.assertFalse(browser.shown("#controls"))
        self.assertTrue(browser.shown("#histogram"))
        self.assertIn("largest move", browser.text("#figures"))
        self.assertIn("rfsmooth report", browser.text("#command"))

    def OnePointAndNoDifferenceAreShown(self):
        browser = None
        for points in ([UTM], waves(500, 0.1)[0]):
            page = self.make(points, points, "--force")
            if browser:
                browser.open(page)
                browser.wait_for("window.rfsmooth")
            browser = browser or self.browse(page)
            browser.keys("#view", "1234")
            for picture in self.sides(browser):
                middle = [row[len(row) // 2 - 60:len(row) // 2 + 60] for row in picture[len(picture) // 2 - 60:len(picture) // 2 + 60]]
                self.assertTrue(any(pixel != (255, 255, 255) for row in middle for pixel in row), f"{len(points)} points")
            self.assertEqual(browser.log("browser"), [])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], sys.argv[4]])
