"""A headless Chromium, driven by its own driver (W3C WebDriver over HTTP): the standard library is all that this needs."""
import json
import struct
import subprocess
import time
import urllib.error
import urllib.request
import zlib
from base64 import b64decode

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"  # as the standard spells it


class Browser:
    """A window of 900 x 600 pixels. WebGL is drawn by the processor."""

    def __init__(self, driver, chromium, profile, arguments=(), preferences=None):
        self.driver = subprocess.Popen([driver, "--port=0"], stdout=subprocess.PIPE, text=True)
        self.address = None
        for line in self.driver.stdout:
            if "successfully on port" in line:
                self.address = "http://127.0.0.1:" + line.rsplit(" ", 1)[1].strip(".\n")
                break
        options = {
            "binary": chromium,
            "args": ["--headless=new", "--no-sandbox", "--window-size=900,600", "--use-angle=swiftshader", "--use-gl=angle",
                     "--enable-unsafe-swiftshader", "--force-device-scale-factor=1", "--hide-scrollbars",
                     "--user-data-dir=" + profile, *arguments],
            "prefs": preferences or {},
        }
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "timeouts": {"script": 300000, "pageLoad": 300000},
                  "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
        self.session = self._ask("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]

    def close(self):
        try:
            self.ask("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()
            self.driver.stdout.close()

    def _ask(self, method, path, body=None):
        request = urllib.request.Request(self.address + path, method=method,
                                         data=None if body is None else json.dumps(body).encode())
        try:
            with urllib.request.urlopen(request, timeout=300) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def ask(self, method, path, body=None):
        return self._ask(method, f"/session/{self.session}{path}", body)

    def open(self, path):
        self.ask("POST", "/url", {"url": "file://" + path})

    def run(self, script, *arguments):
        return self.ask("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def wait_for(self, expression, seconds=300):
        end = time.monotonic() + seconds
        while not self.run("return " + expression):
            if time.monotonic() > end:
                raise TimeoutError(expression)
            time.sleep(0.05)

    def element(self, selector):
        return self.ask("POST", "/element", {"using": "css selector", "value": selector})

    def text(self, selector):
        return self.ask("GET", f"/element/{self.element(selector)[ELEMENT]}/text")

    def shown(self, selector):
        return self.ask("GET", f"/element/{self.element(selector)[ELEMENT]}/displayed")

    def click(self, selector):
        self.ask("POST", f"/element/{self.element(selector)[ELEMENT]}/click", {})

    def keys(self, selector, text):
        self.ask("POST", f"/element/{self.element(selector)[ELEMENT]}/value", {"text": text})

    def pointer(self, kind, *fingers):
        """Every finger: (selector, [(x, y), ...]), pixels from where the element's middle is now: down at the first place, along
        the others, up."""
        actions = []
        for k, (selector, places) in enumerate(fingers):
            box = self.ask("GET", f"/element/{self.element(selector)[ELEMENT]}/rect")
            middle = round(box["x"] + box["width"] / 2), round(box["y"] + box["height"] / 2)
            at = [{"type": "pointerMove", "duration": 0, "origin": "viewport", "x": middle[0] + x, "y": middle[1] + y}
                  for x, y in places]
            steps = [at[0], {"type": "pointerDown", "button": 0}, *at[1:], {"type": "pointerUp", "button": 0}]
            actions.append({"type": "pointer", "id": f"{kind}{k}", "parameters": {"pointerType": kind}, "actions": steps})
        self.ask("POST", "/actions", {"actions": actions})

    def next_frame(self):
        """Returns when what was asked for is on the screen: twice a frame."""
        self.ask("POST", "/execute/async", {
            "script": "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));", "args": []})

    def picture(self, selector):
        """What the screen shows there: rows of (r, g, b)."""
        self.next_frame()
        return decoded_png(b64decode(self.ask("GET", f"/element/{self.element(selector)[ELEMENT]}/screenshot")))

    def log(self, kind):
        return self.ask("POST", "/se/log", {"type": kind})


def decoded_png(data):
    """The pixels of a PNG of 8 bits a channel, red green blue (and alpha, which is left out)."""
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, bits, colors, _, _, interlaced = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    assert bits == 8 and colors in (2, 6) and not interlaced
    channels = 3 if colors == 2 else 4
    raw, stride = zlib.decompress(packed), width * channels
    rows, above = [], bytearray(stride)
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride if kind else 0):
            a, b = (line[x - channels] if x >= channels else 0), above[x]
            c = above[x - channels] if x >= channels else 0
            if kind == 1:
                guess = a
            elif kind == 2:
                guess = b
            elif kind == 3:
                guess = (a + b) // 2
            else:
                nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))
                guess = nearest[2]
            line[x] = (line[x] + guess) & 255
        rows.append([tuple(line[x:x + 3]) for x in range(0, stride, channels)])
        above = line
    return rows
