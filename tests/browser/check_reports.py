"""Opens the HTML reports of the command in headless Chromium.

usage: check_reports.py SHEAF CHROMIUM [FOLDER]

Makes reports of small scenes, looks at each as a phone and as a desk would show it, light and dark: no errors on the
console, nothing loaded from elsewhere, nothing wider than the screen, no layout that shifts, charts and pictures drawn.
FOLDER: reports and screenshots are kept there. Prints one line per fault; exits with 1 if there are any.

The browser is spoken to by its DevTools protocol, JSON messages with a zero byte behind each, over two pipes.
"""

import base64
import json
import os
import pathlib
import subprocess
import sys
import tempfile

SIZES = {"phone": (390, 844, True), "desk": (1280, 900, False)}
SCHEMES = ("light", "dark")
REPORTS = {
    "bench": ["bench", "builtin:terrain?n=65", "--size", "320x200", "--views", "inside", "--frames", "8"],
    "bench-one": ["bench", "builtin:sphere?n=8", "--size", "64x64", "--frames", "1"],
    "compare": ["compare", "builtin:teapot?n=6", "--size", "480x320", "--views", "orbit:6"],
    "compare-one": ["compare", "builtin:teapot?n=6", "--size", "1500x900", "--max-error", "3"],
}
CHARTS = {"bench": 3, "bench-one": 1, "compare": 2, "compare-one": 0}

# What the page says about itself; a list of faults.
LOOK = """
(async () => {
  const faults = [];
  const width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > width)
    faults.push(`the page is ${document.documentElement.scrollWidth} pixels wide on a screen of ${width}`);
  for (const e of document.body.querySelectorAll("*")) {
    if (e.closest(".scroll, .uplot, details:not([open])")) continue;
    const box = e.getBoundingClientRect();
    if (box.right > width + 0.5 || box.left < -0.5) faults.push(`<${e.tagName} class="${e.className}"> sticks out`);
  }
  for (const image of document.images)
    if (!image.complete || image.naturalWidth === 0) faults.push(`picture "${image.alt}" is not shown`);
  const charts = document.querySelectorAll(".lines");
  if (charts.length !== EXPECTED_CHARTS) faults.push(`${charts.length} charts in place of EXPECTED_CHARTS`);
  for (const chart of charts) {
    const canvas = chart.querySelector("canvas");
    if (!canvas || canvas.width === 0) { faults.push("a chart is missing"); continue; }
    const box = canvas.getBoundingClientRect();
    const outer = chart.getBoundingClientRect();
    if (box.right > outer.right + 0.5) faults.push("a chart is wider than its place");
    if (chart.scrollHeight > chart.clientHeight + 1)
      faults.push(`a chart is ${chart.scrollHeight} pixels high in a place of ${chart.clientHeight}`);
    const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    let drawn = 0;
    for (let i = 3; i < pixels.length; i += 4) drawn += pixels[i] > 0;
    if (drawn < 200) faults.push("a chart is empty");
    const over = chart.querySelector(".u-over");
    const at = over.getBoundingClientRect();
    const where = { clientX: at.left + at.width / 2, clientY: at.top + at.height / 2, bubbles: true };
    over.dispatchEvent(new MouseEvent("mouseenter", where));
    over.dispatchEvent(new MouseEvent("mousemove", where));
    await new Promise((resolve) => setTimeout(resolve, 50));
    for (const value of chart.previousElementSibling.querySelectorAll("output"))
      if (value.textContent === "") faults.push("the legend does not follow the pointer");
  }
  for (const bar of document.querySelectorAll(".bar svg"))
    if (bar.querySelectorAll("rect").length < 5) faults.push("a bar is empty");
  const [r, g, b] = getComputedStyle(document.body).backgroundColor.match(/[0-9]+/g).map(Number);
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  if (dark !== (r + g + b < 384)) faults.push("the background does not follow the colour scheme");
  const shifts = await new Promise((resolve) => {
    new PerformanceObserver((list) => resolve(list.getEntries())).observe({ type: "layout-shift", buffered: true });
    setTimeout(() => resolve([]), 300);
  });
  const shifted = shifts.reduce((sum, entry) => sum + entry.value, 0);
  if (shifted > 0.01) faults.push(`the layout shifts by ${shifted}`);
  return faults;
})()
"""


class Browser:
    """A headless Chromium with one tab."""

    def __init__(self, program, profile):
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()
        # The protocol is spoken on descriptors 3 and 4; ours may be these numbers, hence the detour.
        detour = [os.dup(to_browser), os.dup(from_browser)]
        while min(detour) < 5:
            detour = [os.dup(d) for d in detour]

        def place():
            os.dup2(detour[0], 3)
            os.dup2(detour[1], 4)

        arguments = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
                     "--remote-debugging-pipe", f"--user-data-dir={profile}", "about:blank"]
        self._process = subprocess.Popen([program, *arguments], preexec_fn=place, pass_fds=(3, 4),
                                         stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for descriptor in [to_browser, from_browser, *detour]:
            os.close(descriptor)
        self._buffer = b""
        self._last_id = 0
        self._session = None
        self.events = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def _receive(self):
        while b"\0" not in self._buffer:
            more = os.read(self._in, 1 << 16)
            if not more:
                sys.exit("the browser has ended")
            self._buffer += more
        message, self._buffer = self._buffer.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **parameters):
        self._last_id += 1
        message = {"id": self._last_id, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._out, data):]
        while True:
            answer = self._receive()
            if answer.get("id") == self._last_id:
                if "error" in answer:
                    sys.exit(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def open(self, path, width, height, mobile, scheme):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.events.clear()
        self.call("Page.navigate", url=path.as_uri())
        while not any(e.get("method") == "Page.loadEventFired" for e in self.events):
            self.events.append(self._receive())

    def evaluate(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            return [str(answer["exceptionDetails"])]
        return answer["result"].get("value")

    def screenshot(self, path):
        image = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(image["data"]))

    def close(self):
        self._session = None
        self.call("Browser.close")
        self._process.wait()


def faults_of_events(events, page):
    for event in events:
        method, parameters = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            yield f"exception: {parameters['exceptionDetails'].get('exception', {}).get('description')}"
        elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
            yield f"console: {parameters['args']}"
        elif method == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
            yield f"log: {parameters['entry']['text']}"
        elif method == "Network.requestWillBeSent":
            url = parameters["request"]["url"]
            if not url.startswith("data:") and url != page.as_uri():
                yield f"loads {url}"


def missed_by_checks(browser, folder):
    """Faults that a page made to have them all is not found to have."""
    path = folder / "faulty.html"
    path.write_text("""<!DOCTYPE html><body style="background: white"><div style="width: 2000px">wide</div>
        <img alt="lost" src="no-such-picture.png"><div class="lines"></div><script>console.error("oh"); undefined.f();
        </script></body>""", encoding="utf-8")
    browser.open(path, *SIZES["phone"], "dark")
    found = browser.evaluate(LOOK.replace("EXPECTED_CHARTS", "0"))
    found += faults_of_events(browser.events, path)
    wanted = ["pixels wide", "sticks out", "is not shown", "1 charts", "a chart is missing", "colour scheme"]
    wanted += ["console:", "exception:", "loads file:"]
    return [want for want in wanted if not any(want in fault for fault in found)]


def make_reports(sheaf, folder):
    for name, arguments in REPORTS.items():
        path = folder / f"{name}.html"
        run = subprocess.run([sheaf, *arguments, "--report", path], stdout=subprocess.DEVNULL, check=False)
        if run.returncode not in (0, 1):
            sys.exit(f"{name}: sheaf exited with {run.returncode}")
        yield name, path


def check(sheaf, chromium, folder, keep):
    faults = 0
    with tempfile.TemporaryDirectory(prefix="sheaf-chromium-", ignore_cleanup_errors=True) as profile:
        browser = Browser(chromium, profile)
        for missed in missed_by_checks(browser, folder):
            print(f"the checks do not find: {missed}")
            faults += 1
        for name, path in make_reports(sheaf, folder):
            for size, (width, height, mobile) in SIZES.items():
                for scheme in SCHEMES:
                    browser.open(path, width, height, mobile, scheme)
                    found = browser.evaluate(LOOK.replace("EXPECTED_CHARTS", str(CHARTS[name])))
                    found += faults_of_events(browser.events, path)
                    for fault in found:
                        print(f"{name}, {size}, {scheme}: {fault}")
                    faults += len(found)
                    if keep:
                        browser.screenshot(folder / f"{name}-{size}-{scheme}.png")
        browser.close()
    return faults


def main(arguments):
    if len(arguments) not in (2, 3):
        sys.exit(__doc__)
    sheaf, chromium = arguments[:2]
    if len(arguments) == 3:
        folder = pathlib.Path(arguments[2]).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        return 1 if check(sheaf, chromium, folder, keep=True) else 0
    with tempfile.TemporaryDirectory(prefix="sheaf-reports-") as folder:
        return 1 if check(sheaf, chromium, pathlib.Path(folder), keep=False) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
