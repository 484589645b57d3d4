"""Opens the page of `web/` in a headless browser as a visitor would, on a desk and on a phone. Run by .ci/page.

    browse.py CHROMIUM DRIVER DIST SCREENSHOTS

Serves DIST on this machine, and checks: the paper flight's number; a preset's verdict; flights with their figures; a
bad file's message; a file of another program; a link that carries the file, and a damaged one; that no page is wider
than its screen; that the keyboard reaches what matters; that nothing is fetched from elsewhere and nothing stands on
the console. Prints sizes and times.
"""

import base64
import gzip
import http.server
import json
import pathlib
import sys
import threading
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

TOP = pathlib.Path(__file__).resolve().parents[2]
PUBLISHED_HASH = (TOP / "tests/paper_flight.sha256").read_text().strip()
SIZES = {"phone": (360, 740), "desk": (1280, 900)}
# A busy machine without a graphics card.
WAIT_S = 120
# All files together, compressed.
SIZE_MAX_BYTES = 2_000_000


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves a folder without words."""

    def log_message(self, *_):
        pass


def browser(chromium, driver):
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    # As root, in a container; 3-D without a graphics card.
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars",
                     "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking",
                     "--disable-component-update", "--disable-quic", "--disable-sync", "--no-first-run"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    found = webdriver.Chrome(options=options, service=Service(driver))
    found.set_page_load_timeout(WAIT_S)
    found.set_script_timeout(WAIT_S)
    return found


class Visitor:
    """Someone with the page open."""

    def __init__(self, chrome, address, size, scheme):
        self.chrome, self.address, self.size, self.scheme = chrome, address, size, scheme
        self.name = f"{size}-{scheme}"
        width, height = SIZES[size]
        chrome.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 2 if size == "phone" else 1,
            "mobile": size == "phone"})
        features = [{"name": "prefers-color-scheme", "value": scheme},
                    {"name": "prefers-reduced-motion", "value": "reduce"}]
        chrome.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": features})
        self.open(address)

    def open(self, address):
        # A link that differs after # alone loads nothing anew.
        self.chrome.get("about:blank")
        started = time.monotonic()
        self.chrome.get(address)
        self.ready()
        return time.monotonic() - started

    def expect(self, holds, what):
        if not holds:
            self.shoot(pathlib.Path(sys.argv[4]), "failed")
            raise SystemExit(f"error: {self.name}: {what}")

    def script(self, text, *arguments):
        return self.chrome.execute_script(text, *arguments)

    def element(self, name):
        found = self.chrome.find_element(By.ID, name)
        self.script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", found)
        return found

    def text(self, name):
        return self.script("return document.getElementById(arguments[0]).textContent", name).strip()

    def until(self, holds, what):
        end = time.monotonic() + WAIT_S
        while not holds():
            self.expect(time.monotonic() < end, f"after {WAIT_S} s: {what}")
            time.sleep(0.1)

    def ready(self):
        self.until(lambda: self.script("return document.body.dataset.state") != "busy", "the page is still busy")

    def fits(self):
        # A phone's browser widens its window to what a page asks for: the screen counts.
        width, screen = self.script("return document.documentElement.scrollWidth"), SIZES[self.size][0]
        self.expect(width <= screen, f"the page is {width} pixels wide on a screen of {screen}")

    def choose(self, preset):
        Select(self.element("preset")).select_by_value(preset)
        self.until(lambda: preset.split("-")[0] in self.script(
            "return document.getElementById('editor').value"), f"{preset} is not in the editor")
        self.ready()
        self.until(lambda: self.text("verdict").startswith(("CERTIFIED", "NOT certified")), "there is no verdict")

    def write(self, text):
        """Puts a text into the editor, as by hand, and certifies it."""
        self.script("""document.getElementById('edit').open = true;
            const editor = document.getElementById('editor');
            editor.value = arguments[0]; editor.dispatchEvent(new Event('input', { bubbles: true }));""", text)
        self.element("certify").click()

    def fly(self):
        self.element("fly").click()
        self.ready()
        self.until(lambda: self.script("return document.querySelectorAll('#flight-figures tbody tr').length") >= 3,
                   "there are no figures of the flight")

    def shoot(self, folder, what):
        self.script("scrollTo({top: 0, behavior: 'instant'})")
        height = self.script("return document.documentElement.scrollHeight")
        clip = {"x": 0, "y": 0, "width": SIZES[self.size][0], "height": height,
                "scale": 0.5 if self.size == "phone" else 1}
        wanted = {"format": "png", "captureBeyondViewport": True, "clip": clip}
        shot = self.chrome.execute_cdp_cmd("Page.captureScreenshot", wanted)
        (folder / f"{self.name}-{what}.png").write_bytes(base64.b64decode(shot["data"]))

    def quiet(self):
        """Nothing on the console, and nothing fetched from elsewhere."""
        severe = [entry for entry in self.chrome.get_log("browser") if "GPU stall" not in entry["message"]
                  and "swiftshader" not in entry["message"].lower()]
        self.expect(not severe, f"on the console: {severe}")
        asked = []
        for entry in self.chrome.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                asked.append(message["params"]["request"]["url"])
        home = self.address.rsplit("/", 1)[0]
        elsewhere = [url for url in asked if not url.startswith((home, "data:", "blob:", "about:"))]
        self.expect(asked and not elsewhere, f"fetched from elsewhere: {elsewhere}")
        return len(asked)


def verdict_and_number(visitor):
    visitor.expect(visitor.text("verdict").startswith("CERTIFIED"), f"the first verdict is {visitor.text('verdict')!r}")
    rows = visitor.script("return document.querySelectorAll('#rows tbody tr').length")
    visitor.expect(rows >= 8, f"the certificate has {rows} rows")
    visitor.until(lambda: len(visitor.text("paper-hash")) == 64, "the paper's flight has no number")
    visitor.expect(visitor.text("paper-hash") == PUBLISHED_HASH, f"the paper's flight is {visitor.text('paper-hash')}")
    said = visitor.text("paper-same")
    visitor.expect(said.startswith("The same"), f"beside it stands {said!r}")


def presets_and_bad_files(visitor, folder):
    visitor.choose("x500")
    visitor.expect(visitor.text("verdict").startswith("CERTIFIED"), f"x500 is {visitor.text('verdict')!r}")
    visitor.expect("2.06 kg" in visitor.text("mass-said"), f"x500's mass is {visitor.text('mass-said')!r}")
    good = visitor.script("return document.getElementById('editor').value")
    visitor.write(good.replace("mass = 2.064", "mass = -2.064"))
    error = visitor.chrome.find_element(By.ID, "error")
    visitor.until(error.is_displayed, "a bad file is not refused")
    visitor.expect("x500.toml: vehicle.mass: must be" in error.text, f"a bad file's message is {error.text!r}")
    visitor.expect(error.get_attribute("role") == "alert", "a screen reader is not told of the error")
    visitor.expect(not visitor.text("verdict").startswith("CERTIFIED"), "a bad file is CERTIFIED")
    visitor.expect("kg" not in visitor.text("mass-said"), "beside a bad file stands the mass of the vehicle before it")
    visitor.shoot(folder, "bad-file")
    slow = good.replace("lag = ", "lag = 1.0 # ")
    visitor.write(slow)
    visitor.until(lambda: visitor.text("verdict").startswith("NOT certified"), "a rotor lag of 1 s is not refused")
    visitor.expect(not error.is_displayed(), "the error stays")
    # The file of another program, which lacks a number.
    visitor.chrome.find_element(By.ID, "file").send_keys(str(TOP / "tests/numbers/vehicle_import/cf2x.urdf"))
    visitor.until(lambda: "rotors.lag" in visitor.text("converted"), "the importer does not say what is missing")
    written = visitor.script("return document.getElementById('editor').value")
    visitor.expect('lag = "missing"' in written, "the missing number is not marked")
    visitor.shoot(folder, "imported")


def flights(visitor, folder):
    visitor.choose("hummingbird")
    visitor.fly()
    figures = visitor.text("flight-figures")
    visitor.expect("INDI" in figures and "m" in figures, f"the figures are {figures!r}")
    plots = visitor.script("return document.querySelectorAll('#plots canvas').length")
    visitor.expect(plots >= 5, f"{plots} plots")
    visitor.fits()
    visitor.shoot(folder, "upside-down")
    Select(visitor.element("task")).select_by_value("wind")
    visitor.script("""const wind = document.getElementById('wind'); wind.value = 8;
        for (const kind of ['input', 'change']) wind.dispatchEvent(new Event(kind, { bubbles: true }));""")
    visitor.until(lambda: visitor.text("flight-figures") != figures, "a slider flies nothing anew")
    visitor.ready()
    visitor.shoot(folder, "wind")


def links(visitor):
    visitor.write(visitor.script("return document.getElementById('editor').value").replace("mass = 0.5", "mass = 0.55"))
    visitor.ready()
    visitor.element("share").click()
    link = lambda: visitor.script("return document.getElementById('share-link').value")
    visitor.until(link, "there is no link")
    address = link()
    visitor.expect(address.startswith(visitor.address + "#"), f"the link is {address[:80]}")
    visitor.open(address)
    written = "return document.getElementById('editor').value"
    visitor.until(lambda: "mass = 0.55" in visitor.script(written), "the link lost the file")
    visitor.open(address[:-9])
    error = visitor.chrome.find_element(By.ID, "error")
    visitor.until(error.is_displayed, "a damaged link is taken")
    visitor.expect("link" in error.text, f"a damaged link's message is {error.text!r}")
    return len(address)


def keyboard(visitor):
    visitor.open(visitor.address)
    reached = []
    for _ in range(60):
        ActionChains(visitor.chrome).send_keys(Keys.TAB).perform()
        reached.append(visitor.script("return document.activeElement.id"))
    for name in ("preset", "file", "task", "wind", "mass", "fly", "share"):
        visitor.expect(name in reached, f"Tab does not reach {name}: {reached}")
    unnamed = visitor.script("""return [...document.querySelectorAll("input, select, textarea, button, canvas")]
        .filter((e) => e.offsetParent && !(e.labels && e.labels.length) && !e.getAttribute("aria-label")
            && !e.getAttribute("aria-hidden") && !e.textContent.trim()).map((e) => e.outerHTML.slice(0, 120))""")
    visitor.expect(not unnamed, f"without a name for a screen reader: {unnamed}")


def sizes(dist):
    files = [path for path in sorted(dist.rglob("*")) if path.is_file()]
    total = 0
    for path in files:
        data = path.read_bytes()
        small = len(gzip.compress(data, 9))
        total += small
        print(f"{len(data):9,d} bytes, {small:9,d} compressed  {path.relative_to(dist)}")
    print(f"{total:,d} bytes compressed")
    if total > SIZE_MAX_BYTES:
        raise SystemExit(f"error: the page has {total} bytes, more than {SIZE_MAX_BYTES}")


def main():
    chromium, driver, dist, folder = sys.argv[1], sys.argv[2], *map(pathlib.Path, sys.argv[3:5])
    folder.mkdir(parents=True, exist_ok=True)
    sizes(dist)
    handler = lambda *given: Quiet(*given, directory=dist)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_port}/index.html"
        chrome = browser(chromium, driver)
        try:
            desk = Visitor(chrome, address, "desk", "light")
            print(f"loaded, with a first verdict: {desk.open(address):.1f} s")
            verdict_and_number(desk)
            presets_and_bad_files(desk, folder)
            flights(desk, folder)
            print(f"a link with the Hummingbird's file: {links(desk)} characters")
            keyboard(desk)
            asked = desk.quiet()
            phone = Visitor(chrome, address, "phone", "dark")
            phone.fits()
            verdict_and_number(phone)
            flights(phone, folder)
            asked += phone.quiet()
            print(f"{asked} requests, all of them to this machine's own server")
        finally:
            chrome.quit()
            server.shutdown()


main()
